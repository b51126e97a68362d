# SPDX-License-Identifier: MIT
"""States of an axisymmetric run turned about the axis x = 0 into solids, as a VTKHDF file of hexahedra and wedges."""
import os

import h5py
import numpy as np
from matplotlib import colormaps

from slideline_tools import UserError
from slideline_tools.fields import default_field, scalar_field
from slideline_tools.files import output
from slideline_tools.results import Results

WEDGE, HEXAHEDRON = 13, 12


def turned(values: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Values (n[, components]) of the plane z = 0 at these angles about y: (angles, n[, components]), x turning to z."""
    cosine, sine = np.cos(angles)[:, None], np.sin(angles)[:, None]
    if values.ndim == 1:
        return np.repeat(values[None], len(angles), axis=0)
    found = np.zeros((len(angles), *values.shape))
    if values.shape[1] == 3:
        x, y = values[:, 0], values[:, 1]
        found[..., 0], found[..., 1], found[..., 2] = cosine * x, y, sine * x
        return found
    radial, axial, hoop, shear = values[:, 0], values[:, 1], values[:, 2], values[:, 3]
    found[..., 0] = cosine**2 * radial + sine**2 * hoop
    found[..., 1] = axial
    found[..., 2] = sine**2 * radial + cosine**2 * hoop
    found[..., 3], found[..., 4] = cosine * shear, sine * shear
    found[..., 5] = cosine * sine * (radial - hoop)
    return found


def solid_cells(cells: np.ndarray, n_node: int, sectors: int, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Connectivity, its offsets and types: a triangle becomes wedges, a quad hexahedra, one a sector, sector by sector."""
    is_triangle = cells[:, 2] == cells[:, 3]
    corners = np.where(is_triangle, 3, 4)
    connectivity = []
    for sector in range(sectors):
        behind = (sector + 1) % sectors if closed else sector + 1
        connectivity += [np.concatenate([row[:n] + sector * n_node, row[:n] + behind * n_node])
                         for row, n in zip(cells, corners, strict=True)]
    offsets = np.concatenate([[0], np.cumsum(np.tile(2 * corners, sectors))])
    return np.concatenate(connectivity), offsets, np.tile(np.where(is_triangle, WEDGE, HEXAHEDRON), sectors)


def plane_angles(results: Results, degrees: float, sectors: int) -> tuple:
    """Angles of the planes of nodes, and the cells between them; of a whole turn the first and last plane are one.

    UserError where the run is not axisymmetric, or the numbers make no solid.
    """
    if "hoop_strain" not in results.cell_fields:
        raise UserError(f"{results.path}: the run is not axisymmetric")
    if not 0.0 < degrees <= 360.0 or not 3 <= sectors <= 720:
        raise UserError("expected an angle above 0 and at most 360 degrees, and 3 to 720 sectors")
    closed = degrees == 360.0
    angles = np.radians(degrees) * np.arange(sectors + (not closed)) / sectors
    return angles, solid_cells(results.cells, results.n_node, sectors, closed)


def write(results: Results, path: str | os.PathLike, degrees: float = 270.0, sectors: int = 36) -> None:
    """Write all states with their fields: vectors and stresses are turned along."""
    angles, (cells, offsets, types) = plane_angles(results, degrees, sectors)
    n_point, n_cell, n_state = len(angles) * results.n_node, len(types), results.n_state
    with h5py.File(output(path, [results.path]), "w") as stream:
        root = stream.create_group("VTKHDF", track_order=True)
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", np.bytes_("UnstructuredGrid"))
        for name, values in {"NumberOfPoints": [n_point], "NumberOfCells": [n_cell], "NumberOfConnectivityIds": [len(cells)],
                             "Connectivity": cells, "Offsets": offsets, "Types": types.astype(np.uint8)}.items():
            root.create_dataset(name, data=values)
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = n_state
        steps["Values"] = results.times
        for name in ("PartOffsets", "NumberOfParts", "CellOffsets", "ConnectivityIdOffsets"):
            shape = (n_state, 1) if name.endswith("dOffsets") or name == "CellOffsets" else (n_state,)
            steps[name] = np.full(shape, int(name == "NumberOfParts"))
        steps["PointOffsets"] = n_point * np.arange(n_state)
        root["Points"] = np.concatenate([turned(state, angles).reshape(-1, 3) for state in results.points])
        # A cell has the values of the middle of its sector.
        for group, names, field, at in (
                ("PointData", results.point_fields, results.point_field, angles),
                ("CellData", results.cell_fields, results.cell_field, angles[:sectors] + 0.5 * angles[1])):
            starts = steps.create_group(f"{group}Offsets")
            for name in names:
                values = field(name)
                once = np.array_equal(values, np.broadcast_to(values[:1], values.shape), equal_nan=True)
                rows = [turned(state, at).reshape(-1, *state.shape[1:]) for state in values[:1 if once else None]]
                root.require_group(group)[name] = np.concatenate(rows)
                starts[name] = (0 if once else len(rows[0])) * np.arange(n_state)


def draw(results: Results, path: str | os.PathLike, name: str | None = None, state: str = "-1", degrees: float = 270.0,
         sectors: int = 36) -> None:
    """Draw one state as a solid, by VTK: a picture (.png) coloured by a field, seen from the side that is cut open."""
    index, angles, (cells, offsets, types) = results.state_index(state), *plane_angles(results, degrees, sectors)
    try:
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    except ImportError:
        raise UserError("a picture takes VTK: pip install vtk; a .vtkhdf file does not") from None
    field = scalar_field(results, name or default_field(results))
    values = np.tile(field.values[index], len(angles) if field.at_nodes else sectors)
    grid, points, array = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(turned(results.points[index], angles).reshape(-1, 3), deep=True))
    array.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(cells, deep=True))
    grid.SetPoints(points)
    grid.SetCells(numpy_to_vtk(types.astype(np.uint8), deep=True), array)
    (grid.GetPointData() if field.at_nodes else grid.GetCellData()).SetScalars(numpy_to_vtk(values, deep=True))
    vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_OFF)  # that there is no screen
    colours = vtk.vtkLookupTable()
    colours.SetNumberOfTableValues(256)
    for k, colour in enumerate(colormaps["viridis"](np.linspace(0.0, 1.0, 256))):
        colours.SetTableValue(k, *colour)
    surface, mapper, actor = vtk.vtkDataSetSurfaceFilter(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
    surface.SetInputData(grid)
    mapper.SetInputConnection(surface.GetOutputPort())
    mapper.SetLookupTable(colours)
    mapper.SetScalarRange(*field.limits([index]))
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.45)
    actor.GetProperty().SetDiffuse(0.6)
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(colours)
    bar.SetTitle(field.label + "\n")
    bar.SetNumberOfLabels(5)
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        text.SetColor(0.0, 0.0, 0.0)
        text.ItalicOff()
    bar.SetMaximumWidthInPixels(90)
    renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
    renderer.AddActor(actor)
    renderer.AddViewProp(bar)
    renderer.SetBackground(1.0, 1.0, 1.0)
    middle = np.radians(degrees) / 2.0 + np.pi + 0.25  # beside the middle of the part that is left open
    renderer.GetActiveCamera().SetPosition(np.cos(middle), 0.5, np.sin(middle))
    renderer.GetActiveCamera().SetViewUp(0.0, 1.0, 0.0)
    renderer.ResetCamera()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(1200, 900)
    window.AddRenderer(renderer)
    window.Render()
    image, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    image.SetInput(window)
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(os.fspath(output(path, [results.path])))
    writer.Write()
