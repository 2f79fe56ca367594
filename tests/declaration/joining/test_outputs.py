"""What an output measures, and how much noise it declares, are checked when the model is joined."""

import pytest

from shipid import Component, constant, join, output, state
from shipid.foundation.errors import DeclarationError, UnitError


def with_gauge(unit: str, measures: str | None, noise: str | None = None) -> type[Component]:
    class Diving(Component):
        """A depth, and a gauge of the pressure."""

        depth = state("m", "depth")
        weight = constant("N/m^3", "specific weight of water", default=10055.0)
        gauge = output(unit, "pressure gauge", measures=measures, noise=noise)

        @depth.rate
        def dive(self):
            """Made up."""
            return 0.0

        @gauge.equals
        def reading(self):
            """Hydrostatics."""
            return self.weight * self.depth if unit == "Pa" else self.depth

    return Diving


def test_an_output_in_another_unit_than_what_it_measures_is_refused() -> None:
    """A column of depths in m was compared with the pressure in Pa."""
    with pytest.raises(UnitError, match=r"'gauge' of Diving is in Pa, and measures 'depth' in m.*a column 'gauge'"):
        join("auv", with_gauge("Pa", "depth"))
    assert join("auv", with_gauge("Pa", None, "200 Pa")).outputs == ("gauge",)


def test_an_output_that_measures_what_is_not_there_is_refused_with_the_nearest() -> None:
    with pytest.raises(
        DeclarationError,
        match=r"'gauge' of Diving measures 'dept', which is no quantity of the model. Did you mean depth\?",
    ):
        join("auv", with_gauge("m", "dept"))


def test_the_noise_of_an_output_has_its_unit() -> None:
    with pytest.raises(UnitError, match=r"noise of 'gauge' in Diving needs the unit m, and Pa does not fit it"):
        join("auv", with_gauge("m", "depth", "200 Pa"))
