"""Scenes from dotted keys, and keys that several tests give."""

from railhead.scene.scene import Scene

HALF = {"rail.extent": "half-space"}
ARC_RAIL = {"rail.profile": "arc", "rail.extent": "half-space"}
ARC_WHEEL = {"wheel.profile": "arc"}


def scene(**keys) -> Scene:
    """Return a scene of 25 kN with some dotted keys set."""
    data = {"load": 25000}
    for key, value in keys.items():
        section, dot, leaf = key.partition(".")
        if dot:
            data.setdefault(section, {})[leaf] = value
        else:
            data[section] = value
    return Scene.from_mapping(data)
