"""Scenes by hypothesis, from the same recipe as the study's random ones."""

from hypothesis import strategies as st

from studies.hard import fuzz_scenes


class Drawn:
    """A source of choices that hypothesis makes and shrinks."""

    def __init__(self, draw) -> None:
        self._draw = draw

    def number(self, low: float, high: float) -> float:
        return self._draw(st.floats(low, high))

    def choice(self, options):
        return self._draw(st.sampled_from(options))


scenes = st.composite(lambda draw: fuzz_scenes.scene(Drawn(draw)))()
