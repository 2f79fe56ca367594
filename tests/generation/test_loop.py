"""The loop over samples: record, samples one by one and threads give the same numbers, compiled or not."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from shipid.generation.loop import Loop, make_loop


def filter_step(n: int = 3) -> Any:
    """A step with everything in it: carried state, control, coefficients, an output of another size."""
    z, c, p = ca.SX.sym("z", n), ca.SX.sym("c", 2), ca.SX.sym("p", n)
    following = 0.9 * z + p * ca.sin(c[0]) + z[0] * c[1]
    return ca.Function("step", [z, c, p], [following, ca.vertcat(ca.sumsqr(z), c[1] * following)])


def by_hand(z: np.ndarray, controls: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    out = []
    for c in controls:
        following = 0.9 * z + p * np.sin(c[0]) + z[0] * c[1]
        out.append([z @ z, *(c[1] * following)])
        z = following
    return z, np.array(out)


@pytest.fixture(scope="module")
def loops() -> dict[str, Loop]:
    return {"compiled": make_loop(filter_step()), "interpreted": make_loop(filter_step(), compiled=False)}


@pytest.fixture
def arguments() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(1)
    return rng.standard_normal(3), 0.1 * rng.standard_normal((40, 2)), rng.standard_normal(3)


@pytest.mark.parametrize("kind", ["compiled", "interpreted"])
def test_a_record(loops: dict[str, Loop], kind: str, arguments: Any) -> None:
    loop = loops[kind]
    assert loop.compiled is (kind == "compiled") and loop.sizes == (3, 2, 3, 4) and loop.dtype is np.float64
    z, out = loop(*arguments)
    wanted_z, wanted = by_hand(*arguments)
    assert z == pytest.approx(wanted_z, rel=1e-12) and out == pytest.approx(wanted, rel=1e-12)
    assert out.shape == (40, 4) and out.flags.c_contiguous


@pytest.mark.parametrize("kind", ["compiled", "interpreted"])
def test_one_at_a_time_to_the_bit(loops: dict[str, Loop], kind: str, arguments: Any) -> None:
    z0, controls, p = arguments
    z, out = loops[kind](z0, controls, p)
    stepper = loops[kind].one_at_a_time(z0, p)
    z0[:] = np.nan  # what it starts from is its own
    rows = []
    for c in controls:
        stepper.control[:] = c
        assert stepper.step() == 0
        rows.append(stepper.out.copy())
    assert np.array_equal(stepper.z, z) and np.array_equal(rows, out)


@pytest.mark.parametrize("kind", ["compiled", "interpreted"])
@pytest.mark.parametrize("threads", [None, 1, 2, 5])
def test_many_records_side_by_side(loops: dict[str, Loop], kind: str, threads: int | None, arguments: Any) -> None:
    """In the order they were given, of any lengths."""
    z0, controls, p = arguments
    lengths = [40, 1, 7, 0, 23, 40]
    starts = [z0 * k for k in range(len(lengths))]
    found = loops[kind].map(starts, [controls[:m] for m in lengths], [p] * len(lengths), threads)
    for start, m, (z, out) in zip(starts, lengths, found):
        alone = loops[kind](start, controls[:m], p)
        assert np.array_equal(z, alone[0]) and np.array_equal(out, alone[1]) and out.shape == (m, 4)


@pytest.mark.parametrize("kind", ["compiled", "interpreted"])
def test_an_empty_record_changes_nothing(loops: dict[str, Loop], kind: str, arguments: Any) -> None:
    z, out = loops[kind](arguments[0], np.empty((0, 2)), arguments[2])
    assert np.array_equal(z, arguments[0]) and out.shape == (0, 4)


def test_any_layout_of_memory(loops: dict[str, Loop], arguments: Any) -> None:
    """Rows in another order in memory, other types: what is read from plain memory is laid out first."""
    z0, controls, p = arguments
    wanted = loops["compiled"](z0, controls, p)[1]
    doubled = np.repeat(np.repeat(controls, 2, axis=0), 2, axis=1)
    for other in (np.asfortranarray(controls), doubled[::2, ::2]):
        assert np.array_equal(loops["compiled"](z0, other, p)[1], wanted)
    whole = np.ones((40, 2), dtype=int)
    assert np.array_equal(loops["compiled"](z0, whole, p)[1], loops["compiled"](z0, whole.astype(float), p)[1])


@pytest.mark.parametrize("kind", ["compiled", "interpreted"])
@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_shapes_that_do_not_fit(loops: dict[str, Loop], kind: str, wrong: int, arguments: Any) -> None:
    """The machine code would read past the end of what it is given."""
    spoilt = list(arguments)
    spoilt[wrong] = spoilt[wrong][..., :-1]
    with pytest.raises(ValueError, match="do not fit the step"):
        loops[kind](*spoilt)
    if wrong != 1:
        with pytest.raises(ValueError, match="do not fit the step"):
            loops[kind].one_at_a_time(spoilt[0], spoilt[2])


def test_a_step_returns_what_it_carries() -> None:
    """One that returns another length would run over the memory of the next."""
    z, c, p = ca.SX.sym("z", 2), ca.SX.sym("c"), ca.SX.sym("p")
    for following in (ca.vertcat(z, c), z[0]):
        with pytest.raises(ValueError, match="a step returns what it carries"):
            make_loop(ca.Function("step", [z, c, p], [following, c]))


def test_nothing_to_carry_and_no_coefficients() -> None:
    """Sizes of zero and one, which are read from memory like any other."""
    z, c, p = ca.SX.sym("z", 1), ca.SX.sym("c", 1), ca.SX(0, 1)
    p = ca.SX.sym("p", 0)
    step = ca.Function("step", [z, c, p], [z + c, z])
    for compiled in (True, False):
        z1, out = make_loop(step, compiled)(np.zeros(1), np.ones((5, 1)), np.empty(0))
        assert z1 == [5.0] and list(out.ravel()) == [0, 1, 2, 3, 4]


def test_single_precision() -> None:
    """Numbers are floats from end to end, and the same as NumPy's floats."""
    loop = make_loop(filter_step(), single=True)
    assert loop.single and loop.dtype is np.float32
    rng = np.random.default_rng(2)
    arguments = rng.standard_normal(3), 0.1 * rng.standard_normal((40, 2)), rng.standard_normal(3)
    z, out = loop(*arguments)
    assert z.dtype == out.dtype == np.float32
    assert z == pytest.approx(by_hand(*arguments)[0], rel=1e-5)
    stepper = loop.one_at_a_time(arguments[0], arguments[2])
    for c in arguments[1]:
        stepper.control[:] = c
        stepper.step()
    assert np.array_equal(stepper.z, z)
    # Coarser than doubles, or it would not be what it says.
    assert np.any(z != make_loop(filter_step())(*arguments)[0].astype(np.float32)) or np.any(
        out.astype(float) != make_loop(filter_step())(*arguments)[1]
    )


def test_without_a_compiler(monkeypatch: pytest.MonkeyPatch, arguments: Any) -> None:
    monkeypatch.setenv("SHIPID_COMPILE", "0")
    loop = make_loop(filter_step())
    assert not loop.compiled
    assert loop(*arguments)[1] == pytest.approx(by_hand(*arguments)[1], rel=1e-12)
    # Floats need machine code; without it the virtual machine computes in doubles, and says so.
    assert not make_loop(filter_step(), single=True).single


def test_the_memory_outlives_the_loop(arguments: Any) -> None:
    """A stepper keeps what it calls: letting go of the loop must not pull the code away."""
    import gc

    stepper = make_loop(filter_step(), compiled=True).one_at_a_time(arguments[0], arguments[2])
    gc.collect()
    stepper.control[:] = arguments[1][0]
    assert stepper.step() == 0 and np.isfinite(stepper.out).all()


def test_a_long_record_on_little_memory(loops: dict[str, Loop]) -> None:
    """Half a million samples in one call, to the same end as in pieces."""
    rng = np.random.default_rng(3)
    z0, controls, p = np.zeros(3), 0.01 * rng.standard_normal((500_000, 2)), np.ones(3)
    whole = loops["compiled"](z0, controls, p)[0]
    z = z0
    for piece in np.array_split(controls, 7):
        z, _ = loops["compiled"](z, piece, p)
    assert np.array_equal(z, whole)


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("threads", [1, 3])
def test_records_of_one_length_side_by_side_are_the_single_ones(compiled, threads):
    z, c, p = ca.SX.sym("z", 2), ca.SX.sym("c", 2), ca.SX.sym("p", 1)
    step = ca.Function(
        "step", [z, c, p], [ca.vertcat(z[0] + p * c[0], z[1] * 0.9 + c[1]), ca.vertcat(z[0] - z[1], p, c[1])]
    )
    loop, random = make_loop(step, compiled=compiled), np.random.default_rng(0)
    starts, own, coefficients = random.normal(size=(5, 2)), random.normal(size=(5, 7, 2)), random.normal(size=(5, 1))
    for controls in (own, own[0]):
        each = [controls[k] if controls.ndim == 3 else controls for k in range(5)]
        wanted = np.stack([loop(starts[k], each[k], coefficients[k])[1] for k in range(5)])
        np.testing.assert_array_equal(loop.side_by_side(starts, controls, coefficients, threads), wanted)
    with pytest.raises(ValueError, match="do not fit the step"):
        loop.side_by_side(starts, own[:, :, :1], coefficients)
