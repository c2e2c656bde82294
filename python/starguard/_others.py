# SPDX-License-Identifier: Apache-2.0
"""Objects of trimesh, PyVista and meshio, and what notebooks show. None of these packages is needed
until it is asked for."""
from __future__ import annotations

import base64
import html
import importlib
from typing import Any, Mapping

import numpy as np

from ._types import Array
from .errors import ArgumentError

_VTK_TETRA = 10
_PICTURE = (480, 360)


def package(name: str) -> Any:
    """An optional package."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"this needs {name}, which cannot be imported: pip install {name}") from error


def trimesh(vertices: Array, faces: Array) -> Any:
    """process=False: the same vertices and faces in the same order."""
    return package("trimesh").Trimesh(vertices=np.array(vertices), faces=faces.astype(np.int64), process=False)


def pyvista_surface(vertices: Array, faces: Array) -> Any:
    rows = np.column_stack([np.full(len(faces), 3, np.int64), faces.astype(np.int64)])
    return package("pyvista").PolyData(np.array(vertices), rows.ravel())


def pyvista_tetrahedra(vertices: Array, tetrahedra: Array, data: Mapping[str, Array]) -> Any:
    rows = np.column_stack([np.full(len(tetrahedra), 4, np.int64), tetrahedra.astype(np.int64)])
    grid = package("pyvista").UnstructuredGrid(
        rows.ravel(), np.full(len(tetrahedra), _VTK_TETRA, np.uint8), np.array(vertices))
    for name, values in data.items():
        grid.cell_data[name] = np.array(values)
    return grid


def meshio(vertices: Array, kind: str, cells: Array, data: Mapping[str, Array]) -> Any:
    return package("meshio").Mesh(np.array(vertices), [(kind, cells.astype(np.int64))],
                                  cell_data={name: [np.array(values)] for name, values in data.items()})


def card(title: str, model: Any, facts: Mapping[str, Any], **options: Any) -> str:
    """HTML: a title, facts, and a picture of a model if there is one that can be drawn."""
    from .pictures import picture

    rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(str(value))}</td></tr>"
                   for name, value in facts.items())
    drawn = ""
    if model is not None and len(model.faces) > 0:
        try:
            png = base64.b64encode(picture(model, size=_PICTURE, **options)).decode()
            drawn = (f'<img alt="{html.escape(title)}" width="{_PICTURE[0]}" height="{_PICTURE[1]}" '
                     f'src="data:image/png;base64,{png}">')
        except ArgumentError:  # what has no extent
            pass
    return f"<div><b>{html.escape(title)}</b>{drawn}<table>{rows}</table></div>"
