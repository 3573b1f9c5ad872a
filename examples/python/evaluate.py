#!/usr/bin/env python3
"""An evaluator to be tested by catoptric: the limit of closed, smooth Catmull-Clark meshes at the points i/2^k.

    catoptric verify mesh.obj --samples-out samples.csv
    python3 evaluate.py mesh.obj samples.csv > results.csv
    catoptric verify mesh.obj --results results.csv --partial

It refines the whole mesh K times by the textbook rules and pushes each vertex to the limit by the masks of Halstead, Kass
& DeRose 1993. So it answers at vertices of the refined mesh only, and leaves the other samples out; that is what --partial
allows. Put your own evaluator in the place of `Refined` and it answers all of them. Standard library only.
"""

import csv
import math
import sys

K = 4  # refinements: reaches i/16 on quads, i/8 on the sub-faces of n-gons


def read_obj(path):
    """Points and faces of an OBJ file; what this evaluator cannot do is refused, not guessed."""
    points, faces = [], []
    for line in open(path):
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([float(x) for x in rest[:3]])
        elif word == "f":
            faces.append([int(x.split("/")[0]) - 1 for x in rest])
        elif word == "t":
            sys.exit(f"{path}: has tags (creases, holes, ...); this example is for smooth meshes")
    return points, faces


def mean(vectors):
    return [sum(x) / len(vectors) for x in zip(*vectors)]


def add(*terms):
    """Sum of factor * vector."""
    return [sum(f * v[i] for f, v in terms) for i in range(3)]


def refine(points, faces):
    """One step of Catmull-Clark. Returns the points, and for each child its face, its number k, and its corners from corner k
    of the face on."""
    face_points = [mean([points[v] for v in face]) for face in faces]
    edges, around = {}, [[] for _ in points]
    for f, face in enumerate(faces):
        for k, a in enumerate(face):
            b = face[(k + 1) % len(face)]
            edges.setdefault((min(a, b), max(a, b)), []).append(f)
            around[a].append((b, f))
    if any(len(sides) != 2 for sides in edges.values()):
        sys.exit("the mesh has a boundary or is not manifold; this example is for closed ones")
    new = []
    for v, fan in enumerate(around):
        n = len(fan)
        if n == 0:
            new.append(points[v])
            continue
        spokes, centres = mean([points[b] for b, _ in fan]), mean([face_points[f] for _, f in fan])
        new.append(add(((n - 2) / n, points[v]), (1 / n, spokes), (1 / n, centres)))
    first_face = len(new)
    new += face_points
    index = {}
    for (a, b), sides in edges.items():
        index[a, b] = len(new)
        new.append(mean([points[a], points[b]] + [face_points[f] for f in sides]))
    children = []
    for f, face in enumerate(faces):
        middle = [index[min(a, b), max(a, b)] for a, b in zip(face, face[1:] + face[:1])]
        for k, v in enumerate(face):
            children.append((f, k, [v, middle[k], first_face + f, middle[k - 1]]))
    return new, children


class Refined:
    """The mesh after K refinements, with the place of every vertex in its ptex face."""

    def __init__(self, points, faces):
        # Ptex faces: a quad is one; an n-gon is n, the child at each of its corners.
        cells, ptex = [], 0
        for face in faces:
            cells.append((ptex, 0.0, 0.0, 1.0, len(face) == 4))
            ptex += 1 if len(face) == 4 else len(face)
        for _ in range(K):
            points, children = refine(points, faces)
            placed = []
            for f, k, _ in children:
                face, u, v, size, quad = cells[f]
                if not quad:
                    placed.append((face + k, 0.0, 0.0, 1.0, True))
                else:
                    size /= 2
                    i, j = [(0, 0), (1, 0), (1, 1), (0, 1)][k]
                    placed.append((face, u + i * size, v + j * size, size, True))
            # Child k starts at corner k; inside a ptex face all cells start at its lower left.
            faces = [turn(corners, k) if cells[f][4] else corners for f, k, corners in children]
            cells = placed
        self.points, self.faces = points, faces
        self.place = {}
        for (face, u, v, size, _), corners in zip(cells, faces):
            for (i, j), vertex in zip([(0, 0), (1, 0), (1, 1), (0, 1)], corners):
                self.place[face, u + i * size, v + j * size] = vertex
        self.next = [{} for _ in points]
        for corners in faces:
            for k, v in enumerate(corners):
                # Counter-clockwise about v: from this spoke over the opposite corner to the next spoke.
                self.next[v][corners[(k + 1) % 4]] = (corners[(k + 2) % 4], corners[(k + 3) % 4])

    def limit(self, vertex):
        """Limit position and normal at a vertex, by the masks."""
        spoke = start = next(iter(self.next[vertex]))
        ring = []
        while not ring or spoke != start:
            opposite, after = self.next[vertex][spoke]
            ring.append((self.points[spoke], self.points[opposite]))
            spoke = after
        n = len(ring)
        position = add((n * n, self.points[vertex]), *[(4, s) for s, _ in ring], *[(1, o) for _, o in ring])
        angle = 2 * math.pi / n
        weight = 1 + math.cos(angle) + math.cos(angle / 2) * math.sqrt(2 * (9 + math.cos(angle)))
        tangents = []
        for shift in (0, 1):
            c = [math.cos(angle * (i - shift)) for i in range(n + 1)]
            tangents.append(add(*[(weight * c[i], s) for i, (s, _) in enumerate(ring)], *[(c[i] + c[i + 1], o) for i, (_, o) in enumerate(ring)]))
        (a, b, c), (d, e, f) = tangents
        return [x / (n * (n + 5)) for x in position], [b * f - c * e, c * d - a * f, a * e - b * d]


def turn(corners, k):
    """The same quad, from its corner -k on."""
    return corners[-k:] + corners[:-k] if k else corners


def main():
    mesh, samples = sys.argv[1:]
    refined = Refined(*read_obj(mesh))
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["face", "u", "v", "x", "y", "z", "nx", "ny", "nz"])
    for row in csv.DictReader(open(samples)):
        vertex = refined.place.get((int(row["face"]), float(row["u"]), float(row["v"])))
        if vertex is not None:
            position, normal = refined.limit(vertex)
            out.writerow([row["face"], row["u"], row["v"], *map(repr, position + normal)])


main()
