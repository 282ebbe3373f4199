"""Pictures of a steel: its curve or its test, its first loops, and how it ratchets."""

from matplotlib.figure import Figure

from railhead.postprocess.findings import Array, Subject
from railhead.postprocess.pictures.diagrams import FE, HERTZ, Target, new_figure


def draw_steel(
    curve: Array,
    loops: Array,
    rates: Array,
    measured: Array | None,
    subject: Subject,
    target: Target = None,
) -> Figure:
    """Three panels: a test or, without one, the curve in tension; loops under cycles of strain; and
    the strain that each cycle of stress adds.

    curve, loops, measured: strain and stress (MPa) of their points (n, 2). rates: strain that the
    cycles add (c,).
    """
    with new_figure(target, 12, 4.4, subject) as figure:
        first, second, third = figure.subplots(1, 3)
        if measured is not None:
            first.plot(100 * measured[:, 0], measured[:, 1], ".", color=HERTZ, label="test")
        first.plot(100 * curve[:, 0], curve[:, 1], color=FE, label="model")
        second.plot(100 * loops[:, 0], loops[:, 1], color=FE)
        for axes in (first, second):
            axes.set(xlabel="strain, %", ylabel="stress, MPa")
        first.legend()
        third.plot(range(1, len(rates) + 1), 100 * rates, ".-", color=FE)
        third.set(xlabel="cycle", ylabel="strain that a cycle adds, %")
    return figure
