#!/usr/bin/python3
"""Puts VTK's picture of a scan, plain points with eye-dome lighting, beside ours: the same view, colours and size.

usage: xvfb-run -a -s '-screen 0 2560x1440x24' /usr/bin/python3 vtk_beside.py CLOUD.ply CAMERA.json OURS.png OUT.png

CLOUD.ply is what `sfumato convert` writes (binary, little endian), CAMERA.json what `--output-camera` does. Points without colours, or with black
ones alone, are coloured by height from blue to yellow, as VTK's users do. Points are 2 px, VTK's usual choice for scans.
"""
import json
import sys

import numpy as np
import vtk
from vtk.util import numpy_support

TYPES = {'char': 'i1', 'uchar': 'u1', 'short': '<i2', 'ushort': '<u2', 'int': '<i4', 'uint': '<u4', 'float': '<f4',
         'double': '<f8', 'int8': 'i1', 'uint8': 'u1', 'int16': '<i2', 'uint16': '<u2', 'int32': '<i4',
         'uint32': '<u4', 'float32': '<f4', 'float64': '<f8'}


def load(path):
    """Positions (n, 3) float64 and colours (n, 3) uint8, or None where there are none."""
    with open(path, 'rb') as file:
        count, fields = 0, []
        for line in iter(file.readline, b'end_header\n'):
            words = line.decode().split()
            if words[0] == 'element':
                count = int(words[2])
            elif words[0] == 'property':
                fields.append((words[2], TYPES[words[1]]))
        rows = np.fromfile(file, np.dtype(fields), count)
    positions = np.stack([rows[axis].astype(np.float64) for axis in 'xyz'], 1)
    colors = None
    if 'red' in rows.dtype.names:
        colors = np.stack([rows[name] for name in ('red', 'green', 'blue')], 1).astype(np.uint8)
    return positions, colors if colors is not None and colors.any() else None


def by_height(positions, up):
    height = positions @ np.asarray(up)
    low, high = np.quantile(height, [0.02, 0.98])
    share = np.clip((height - low) / max(high - low, 1e-12), 0, 1)[:, None]
    return (np.array([40, 60, 200]) * (1 - share) + np.array([250, 220, 60]) * share).astype(np.uint8)


def draw(positions, colors, camera, width, height):
    center = np.array(camera['target'])
    data = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk((positions - center).astype(np.float32), deep=1))
    data.SetPoints(points)
    scalars = numpy_support.numpy_to_vtk(colors, deep=1, array_type=vtk.VTK_UNSIGNED_CHAR)
    data.GetPointData().SetScalars(scalars)
    cells = vtk.vtkCellArray()
    cells.SetData(numpy_support.numpy_to_vtkIdTypeArray(np.arange(len(positions) + 1, dtype=np.int64), deep=1),
                  numpy_support.numpy_to_vtkIdTypeArray(np.arange(len(positions), dtype=np.int64), deep=1))
    data.SetVerts(cells)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetColorModeToDirectScalars()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetPointSize(2)
    actor.GetProperty().LightingOff()
    renderer = vtk.vtkRenderer()
    renderer.AddActor(actor)
    renderer.SetBackground(1, 1, 1)
    shading = vtk.vtkEDLShading()
    shading.SetDelegatePass(vtk.vtkRenderStepsPass())
    renderer.SetPass(shading)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    view = renderer.GetActiveCamera()
    view.SetPosition(*(np.array(camera['position']) - center))
    view.SetFocalPoint(0, 0, 0)
    view.SetViewUp(*camera['up'])
    view.SetViewAngle(camera.get('fov_y_deg', 45))
    if camera.get('projection') == 'orthographic':
        view.ParallelProjectionOn()
        view.SetParallelScale(camera['height_world'] / 2)
    renderer.ResetCameraClippingRange()
    window.Render()
    capture = vtk.vtkWindowToImageFilter()
    capture.SetInput(window)
    capture.ReadFrontBufferOff()
    capture.Update()
    return capture


def main():
    cloud, camera_file, ours, out = sys.argv[1:5]
    with open(camera_file) as file:
        camera = json.load(file)
    reader = vtk.vtkPNGReader()
    reader.SetFileName(ours)
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    rgb = vtk.vtkImageExtractComponents()
    rgb.SetInputConnection(reader.GetOutputPort())
    rgb.SetComponents(0, 1, 2)
    positions, colors = load(cloud)
    if colors is None:
        colors = by_height(positions, camera['up'])
    capture = draw(positions, colors, camera, width, height)
    beside = vtk.vtkImageAppend()
    beside.AddInputConnection(rgb.GetOutputPort())
    beside.AddInputConnection(capture.GetOutputPort())
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(out)
    writer.SetInputConnection(beside.GetOutputPort())
    writer.Write()


main()
