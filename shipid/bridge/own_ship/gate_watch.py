"""How many of the recent samples the filter of the own ship rejects, of all sensors and of each, and whether it keeps a wrong heading."""

from __future__ import annotations

from shipid.estimation.online.online_estimate import OnlineEstimate

#: Shares are those of so many seconds; rejected samples are many above these shares, of all sensors and of a single one.
_RECENT, _MANY, _MANY_OF_ONE = 60.0, 0.2, 0.5
#: A heading that is refused for so many seconds, and so many times, without one that is taken is the right one.
REFUSED, _OFTEN = 30.0, 10


class GateWatch:
    """Watches which samples a filter takes and which it rejects.

    Attributes
    ----------
    rejected : float
        Share of the recent samples that is beyond the gate.
    """

    def __init__(self) -> None:
        self.rejected = 0.0
        self._t = 0.0
        #: Of each sensor, when it was heard last and the share of it that is rejected.
        self._of_each: dict[str, tuple[float, float]] = {}
        #: Since when the heading is refused, and how often.
        self._refused: tuple[float, int] | None = None

    @property
    def many(self) -> bool:
        """Whether many samples are rejected, of all sensors together or of a single one."""
        return self.rejected > _MANY or any(share > _MANY_OF_ONE for _, share in self._of_each.values())

    def look(self, t: float, estimate: OnlineEstimate) -> None:
        """Follow the shares.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        estimate : OnlineEstimate
            With what was taken and rejected at that time.
        """
        heard, gone = (*estimate.taken, *estimate.rejected), len(estimate.rejected)
        if heard:
            self.rejected += min((t - self._t) / _RECENT, 1.0) * (gone / len(heard) - self.rejected)
        self._t = t
        for name in heard:
            before, share = self._of_each.get(name, (t, 0.0))
            newest = min((t - before) / _RECENT, 1.0)
            self._of_each[name] = t, share + newest * ((name in estimate.rejected) - share)

    def refuses_the_heading(self, t: float, estimate: OnlineEstimate) -> bool:
        """Return whether the filter keeps a heading that nothing has confirmed for long, as it would go on to do for ever.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        estimate : OnlineEstimate
            With what was taken and rejected at that time.
        """
        if "psi" in estimate.taken:
            self._refused = None
        elif "psi" in estimate.rejected:
            since, count = self._refused or (t, 0)
            self._refused = since, count + 1
            return t - since > REFUSED and count >= _OFTEN
        return False

    def begin_anew(self) -> None:
        """Forget the heading that was refused."""
        self._refused = None
