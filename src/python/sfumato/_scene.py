"""Several clouds in one picture."""
import os

from . import _engine
from ._cloud import Cloud, items_of
from ._error import Error
from ._look import KEYWORDS, Look, options_of
from ._techniques import settings_of, text_of


class Item:
    """Points of a scene: where they stand, and how they are drawn.

    Parameters
    ----------
    points : path, array (N, 3), `Cloud`, or a point cloud of another library
        Of arrays make a `Cloud` to give colours.
    transform : array (4, 4), optional
        From the coordinates of the points to those of the scene; the last row is 0 0 0 1. Normals and radii follow.
    technique : str, optional
        Draws this item, in place of the scene's technique.
    **parameters
        Of that technique: ``Item("machine.ply", technique="points", point_size=3)``.
    """

    def __init__(self, points, transform=None, technique=None, **parameters):
        if parameters and technique is None:
            raise Error("parameters of an item are those of its technique: name it")
        settings_of(parameters)
        self.points = os.fspath(points) if isinstance(points, (str, os.PathLike)) else points
        self.transform = transform
        self.technique = technique
        self.parameters = parameters

    def _rows(self):
        """The transform as 16 numbers, row by row."""
        if self.transform is None:
            return None
        import numpy as np

        matrix = np.asarray(self.transform, float)
        if matrix.shape != (4, 4):
            raise Error(f"transform: found an array of shape {matrix.shape}, expected (4, 4)")
        return matrix.reshape(-1).tolist()

    def __repr__(self):
        drawn = f", {self.technique}" if self.technique else ""
        return f"<Item {self.points!r}{drawn}{', moved' if self.transform is not None else ''}>"


class Scene:
    """Clouds that are drawn together, each by its own technique, in one light. `render` and `Renderer` take it as points.

    >>> scene = sfumato.Scene(["hall.e57", sfumato.Item("machine.ply", moved, technique="surface")], technique="points")
    >>> sfumato.render(scene, shadows="soft").save("hall.png")

    Parameters
    ----------
    items : list of `Item`, or what one is made of
    draw : list of str
        Rules as in `render`, before those of the items.
    camera : `Camera`, optional
    **look
        Keywords and parameters of `render` that hold unless others are given there: ``technique="points", shadows="soft"``.

    `Scene.load` and `save` are ``--scene`` and ``--save-scene`` of the command, with the same pictures.
    """

    def __init__(self, items=(), draw=(), camera=None, **look):
        self.items = [item if isinstance(item, Item) else Item(item) for item in ([items] if isinstance(items, (str, os.PathLike)) else items)]
        self.draw = [draw] if isinstance(draw, str) else list(draw)
        self.camera = camera
        settings_of({name: value for name, value in look.items() if name not in KEYWORDS}, KEYWORDS)
        self.look = look
        self._loaded = None

    @classmethod
    def load(cls, file):
        """A scene file. Names in it are relative to it. Raises `Error`: "bad_input" when it is none, "io"."""
        loaded = Look.load(file)
        scene = cls(draw=loaded.keywords.pop("draw", ()), camera=loaded.camera)
        for name, rows in loaded.files:
            scene.items.append(Item(name, None if rows is None else [rows[k:k + 4] for k in (0, 4, 8, 12)]))
        scene._loaded = loaded
        return scene

    def rules(self):
        """The rules of the whole scene, as ``--draw`` takes them: its own, then those of its items."""
        rules = list(self.draw)
        for number, item in enumerate(self.items, 1):
            if item.technique:
                words = [f"{name}={text_of(name, value)}" for name, value in item.parameters.items()]
                rules.append(f"{f'file {number}' if len(self.items) > 1 else '*'}: {' '.join([item.technique, *words])}")
        return rules

    def _look(self):
        """What holds unless something else is given."""
        if self._loaded is None and not self.look:
            look = Look()
        elif self._loaded is None:
            look = Look.of(self.look)
        else:
            look = Look.of(self.look)
            look.keywords = {**self._loaded.keywords, **look.keywords}
            look.parameters = self._loaded.parameters + look.parameters
            look.view = {**self._loaded.view, **look.view}
            look.file = self._loaded.file
        look.file = look.file or "scene"
        look.camera = self.camera
        if self.rules():
            look.keywords["draw"] = self.rules()
        return look

    def _sources(self):
        if not self.items:
            raise Error("the scene has no items")
        sources = []
        for item in self.items:
            found = items_of([item.points], item._rows())
            if len(found) != 1 and self.rules():
                raise Error(f"{item.points}: an item is one cloud")
            sources += found
        return sources

    def save(self, file, camera=None):
        """Writes files, rules, look and camera as JSON, for `Scene.load` and ``sfumato --scene``. The file appears when complete.

        `camera` is by default that of the scene; without any, whoever draws it chooses. Raises `Error` ("usage") when an item is
        no file: `write` makes one.
        """
        for item in self.items:
            if not isinstance(item.points, str):
                raise Error(f"a scene file names files, and {type(item.points).__name__} is none: sfumato.write(...) makes one")
        look = self._look()
        files = [(item.points, item._rows()) for item in self.items]
        _engine.save_preset(os.fspath(file), look.keywords.get("technique", "auto"), look.parameters,
                            options_of(look.keywords), camera or self.camera, files)

    def __repr__(self):
        return f"<Scene of {', '.join(map(repr, self.items)) or 'nothing'}>"
