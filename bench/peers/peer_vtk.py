#!/usr/bin/python3
"""VTK 9 peer: loads a gen_tori PLY, renders it off screen, prints one JSON line per mode.

usage: xvfb-run -a -s '-screen 0 1024x1024x24' \\
         /usr/bin/python3 peer_vtk.py FILE.ply MODE[,MODE...] [FRAMES] [SIZE]
modes: points lit_points edl gauss gauss_fill peel4 peel6 peel_exact oit gauss_oit gauss_peel4 array views

gauss: VTK's default soft splats out to 1.5 spacings; gauss_fill: opaque discs of radius one mean spacing.
array: from arrays of numpy to a PNG, 1 px, unlit. views: 30 views as arrays, in turns of a degree.
VTK 9.1 has no UseOIT switch: translucent geometry with peeling off goes through its weighted OIT pass.
Camera: eye (0, -3.2, 2.2), looks at the origin, up z, 45 degrees, orbits 1 degree per frame. The median over
the frames after a warm-up. With PNG_DIR set the last frame of each mode is kept there.
"""
import json
import os
import resource
import statistics
import sys
import tempfile
import time

import numpy as np
import vtk
from vtk.util import numpy_support

PEELS = {'peel4': 4, 'peel6': 6, 'peel_exact': 200, 'gauss_peel4': 4}
VIEWS = 30
TORI_AREA = 4 * np.pi ** 2 * 0.9  # sum of 4 pi^2 R r over the tubes 0.45, 0.30, 0.15
RECORD = np.dtype([('position', '<f4', 3), ('normal', '<f4', 3), ('rgba', 'u1', 4)])


def load(path):
    with open(path, 'rb') as file:
        count = 0
        for line in iter(file.readline, b'end_header\n'):
            if line.startswith(b'element vertex'):
                count = int(line.split()[2])
        return np.fromfile(file, RECORD, count)


def poly_data(cloud, with_alpha, with_cells):
    data = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(np.ascontiguousarray(cloud['position']), deep=1))
    data.SetPoints(points)
    colors = np.ascontiguousarray(cloud['rgba'] if with_alpha else cloud['rgba'][:, :3])
    scalars = numpy_support.numpy_to_vtk(colors, deep=1, array_type=vtk.VTK_UNSIGNED_CHAR)
    scalars.SetName('rgba')
    data.GetPointData().SetScalars(scalars)
    normals = numpy_support.numpy_to_vtk(np.ascontiguousarray(cloud['normal']), deep=1)
    normals.SetName('n')
    data.GetPointData().SetNormals(normals)
    if with_cells:
        count = len(cloud)
        cells = vtk.vtkCellArray()
        cells.SetData(numpy_support.numpy_to_vtkIdTypeArray(np.arange(count + 1, dtype=np.int64), deep=1),
                      numpy_support.numpy_to_vtkIdTypeArray(np.arange(count, dtype=np.int64), deep=1))
        data.SetVerts(cells)
    return data


def mapper_of(data, mode, count):
    if not mode.startswith('gauss'):
        mapper = vtk.vtkPolyDataMapper()
    else:
        mapper = vtk.vtkPointGaussianMapper()
        mapper.EmissiveOff()
        spacing = float(np.sqrt(TORI_AREA / count))
        mapper.SetScaleFactor(spacing / 2)  # the quad reaches 3 sigma = 1.5 spacings
        if mode != 'gauss':  # a disc of radius one spacing
            mapper.SetScaleFactor(spacing)
            mapper.SetTriangleScale(1.0)
            mapper.SetSplatShaderCode('//VTK::Color::Impl\n'
                                      'float d = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);\n'
                                      'if (d > 1.0) discard;\n')
    mapper.SetInputData(data)
    mapper.SetScalarModeToUsePointData()
    mapper.SetColorModeToDirectScalars()
    return mapper


def scene(mapper, mode, translucent, size):
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetPointSize(1)
    actor.GetProperty().SetLighting(mode != 'points')
    if translucent:
        actor.ForceTranslucentOn()
        actor.GetProperty().SetOpacity(0.5)
    renderer = vtk.vtkRenderer()
    renderer.AddActor(actor)
    renderer.SetBackground(1, 1, 1)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.SetAlphaBitPlanes(1)
    window.AddRenderer(renderer)
    if 'peel' in mode:
        renderer.SetUseDepthPeeling(1)
        renderer.SetOcclusionRatio(0.0)
        renderer.SetMaximumNumberOfPeels(PEELS[mode])
    if 'oit' in mode:
        renderer.SetUseDepthPeeling(0)
    if mode == 'edl':
        shading = vtk.vtkEDLShading()
        shading.SetDelegatePass(vtk.vtkRenderStepsPass())
        renderer.SetPass(shading)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(0, -3.2, 2.2)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(45)
    camera.SetClippingRange(0.5, 10)
    return window, renderer, camera


def timed_ms(action):
    start = time.perf_counter()
    action()
    return 1e3 * (time.perf_counter() - start)


def run(path, mode, frames, size):
    start = time.perf_counter()
    cloud = load(path)
    load_ms = 1e3 * (time.perf_counter() - start)
    translucent = 'peel' in mode or 'oit' in mode
    data = poly_data(cloud, translucent or mode == 'gauss', not mode.startswith('gauss'))
    window, renderer, camera = scene(mapper_of(data, mode, len(cloud)), mode, translucent, size)

    def draw():
        window.Render()
        window.WaitForCompletion()

    first_ms = timed_ms(draw)
    times = []
    for _ in range(frames + 1):
        camera.Azimuth(1)
        renderer.ResetCameraClippingRange()
        times.append(timed_ms(draw))
    times = times[1:] or times

    capture = vtk.vtkWindowToImageFilter()
    capture.SetInput(window)
    capture.ReadFrontBufferOff()
    capture.Update()
    pixels = numpy_support.vtk_to_numpy(capture.GetOutput().GetPointData().GetScalars())
    if os.environ.get('PNG_DIR'):
        writer = vtk.vtkPNGWriter()
        writer.SetFileName(os.path.join(os.environ['PNG_DIR'], 'vtk_%s_%d.png' % (mode, len(cloud))))
        writer.SetInputData(capture.GetOutput())
        writer.Write()
    print(json.dumps({
        'peer': 'vtk ' + vtk.vtkVersion().GetVTKVersion(), 'mode': mode, 'n': len(cloud), 'size': size,
        'frame_ms': round(statistics.median(times), 2), 'min_ms': round(min(times), 2),
        'max_ms': round(max(times), 2), 'frames': len(times), 'first_ms': round(first_ms, 1), 'load_ms': round(load_ms, 1),
        'coverage': round(float((pixels[:, :3].min(axis=1) < 250).mean()), 4),
        'peak_mb': resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024}), flush=True)


def read_back(window):
    capture = vtk.vtkWindowToImageFilter()
    capture.SetInput(window)
    capture.SetInputBufferTypeToRGB()
    capture.ReadFrontBufferOff()
    capture.Update()
    return capture.GetOutput()


def of_arrays(path, mode, size):
    """What others do in a script, from arrays that are there when the clock starts."""
    cloud = load(path)
    xyz, rgb = cloud['position'].astype(np.float64), np.ascontiguousarray(cloud['rgba'][:, :3])
    arrays = np.empty(len(xyz), RECORD)
    start = time.perf_counter()
    arrays['position'], arrays['rgba'][:, :3] = xyz, rgb
    window, renderer, camera = scene(mapper_of(poly_data(arrays, False, True), 'points', len(xyz)), 'points', False, size)
    result = {'peer': 'vtk ' + vtk.vtkVersion().GetVTKVersion(), 'mode': mode, 'n': len(xyz)}
    if mode == 'array':
        window.Render()
        with tempfile.TemporaryDirectory() as folder:
            writer = vtk.vtkPNGWriter()
            writer.SetFileName(folder + '/picture.png')
            writer.SetInputData(read_back(window))
            writer.Write()
            result['array_ms'] = round(1e3 * (time.perf_counter() - start), 1)
    else:
        window.Render()
        start = time.perf_counter()
        for _ in range(VIEWS):
            camera.Azimuth(1)
            renderer.ResetCameraClippingRange()
            window.Render()
            numpy_support.vtk_to_numpy(read_back(window).GetPointData().GetScalars())
        result['view_ms'] = round(1e3 * (time.perf_counter() - start) / VIEWS, 1)
    result['peak_mb'] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    print(json.dumps(result), flush=True)


def interact(path):
    """The interactor of a window on the display: a drag of the left button, a picture for every move of the mouse."""
    began = time.perf_counter()
    cloud = load(path)
    window, renderer, _ = scene(mapper_of(poly_data(cloud, False, True), 'points', len(cloud)), 'points', False, 1024)
    window.SetOffScreenRendering(0)
    window.SetSize(950, 694)
    interactor = vtk.vtkRenderWindowInteractor()
    interactor.SetRenderWindow(window)
    interactor.SetInteractorStyle(vtk.vtkInteractorStyleTrackballCamera())
    interactor.Initialize()
    window.Render()
    window.WaitForCompletion()
    first_ms = 1e3 * (time.perf_counter() - began)
    x, y, times = 475, 350, []
    interactor.SetEventInformation(x, y, 0, 0)
    interactor.LeftButtonPressEvent()
    for k in range(40):
        x, y = x + (3 if k % 20 < 10 else -3), y + k % 5 - 2
        start = time.perf_counter()
        interactor.SetEventInformation(x, y, 0, 0)
        interactor.MouseMoveEvent()
        window.WaitForCompletion()
        times.append(1e3 * (time.perf_counter() - start))
    interactor.LeftButtonReleaseEvent()
    print(json.dumps({'peer': 'vtk ' + vtk.vtkVersion().GetVTKVersion(), 'mode': 'interactor', 'n': len(cloud),
                      'motion_ms': round(statistics.mean(times[5:]), 1), 'first_ms': round(first_ms, 1)}), flush=True)


def main():
    path, modes = sys.argv[1], sys.argv[2].split(',')
    frames = int(sys.argv[3]) if len(sys.argv) > 3 else 7
    size = int(sys.argv[4]) if len(sys.argv) > 4 else 1024
    for mode in modes:
        if mode == 'interactor':
            interact(path)
            continue
        if mode in ('array', 'views'):
            of_arrays(path, mode, size)
            continue
        run(path, mode, frames, size)


main()
