#!/usr/bin/python3
"""Ten lines from a scan to a figure.   figure.py [SCAN] [OUT.png]"""
import sys

import sfumato

scan = sys.argv[1] if len(sys.argv) > 1 else sfumato.synth("courtyard", points=300_000)
cloud = sfumato.read(scan) if isinstance(scan, str) else scan
picture = sfumato.render(cloud, technique="surface", shadows="soft", ground=True, size=(1280, 720))
print(*picture.notes, sep="\n")
picture.save(sys.argv[2] if len(sys.argv) > 2 else "figure.png")
