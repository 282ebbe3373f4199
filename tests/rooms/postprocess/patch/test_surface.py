"""The contact surface as triangles between the nodes of its facets."""

import basix
import numpy as np
import pytest

from railhead.postprocess.patch import surface


@pytest.mark.parametrize(
    ("cell", "degree"),
    [
        ("tetrahedron", 1),
        ("tetrahedron", 2),
        ("tetrahedron", 3),
        ("hexahedron", 1),
        ("hexahedron", 2),
    ],
)
def test_the_triangles_of_a_facet_cover_it_once(cell: str, degree: int) -> None:
    """Equal parts of the reference facet, whose nodes are in the order of dolfinx."""
    kind = basix.CellType.triangle if cell == "tetrahedron" else basix.CellType.quadrilateral
    variant = basix.LagrangeVariant.equispaced
    nodes = basix.create_element(basix.ElementFamily.P, kind, degree, variant).points
    first, second, third = nodes[np.array(surface._TRIANGLES[cell, degree])].transpose(1, 0, 2)
    areas = np.linalg.det(np.stack([second - first, third - first], axis=1)) / 2
    whole = 0.5 if cell == "tetrahedron" else 1.0
    assert np.abs(areas) == pytest.approx(whole / len(areas))
    middle = (first + second + third).mean(axis=0) / 3
    assert middle == pytest.approx(np.full(2, 1 / 3 if cell == "tetrahedron" else 1 / 2))
