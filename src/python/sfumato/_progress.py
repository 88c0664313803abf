"""Bars and callbacks that want to know how far the work is."""


def callback(progress):
    """None, a function of (share, text), or a bar as tqdm makes them, as such a function."""
    if progress is None or not hasattr(progress, "update"):
        return progress
    bar, last = progress, [None]

    def update(share, text):
        if text != last[0]:  # a step of the work begins: reading, sorting, normals ...
            last[0] = text
            bar.reset(total=1.0)
            bar.set_description(text, refresh=False)
        bar.update(max(0.0, share - bar.n))

    return update
