"""Random structures: the certificate never lies, hardly ever abstains, and every failure has a name and a place."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
import pytest

from hoblock.blocks import BlockStructure
from hoblock.curves import (
    Arc,
    ArcLength,
    Bezier,
    BSpline,
    Ellipse,
    LagrangeEdge,
    LevelSet,
    NodalCurve,
    Nurbs,
    Parametric,
    Polyline,
    Spline,
)
from hoblock.errors import HoblockError, InvalidMeshError
from hoblock.generate import generate, raise_if_invalid
from hoblock.grading import (
    BoundaryLayer,
    Cosine,
    Cubic,
    Exponential,
    Function,
    Geometric,
    Listed,
    Quadratic,
    Tanh,
    TanhSpacing,
    Uniform,
)
from hoblock.quality import INVALID, UNDECIDED, VALID, certify
from hoblock.reference import gauss_lobatto, lagrange, lagrange_derivative

PLACE = re.compile(r"edge|vertex|vertices|block|element|counts")
SAMPLES = 40


def grid_layout(rng):
    columns, rows = rng.integers(1, 4, 2)
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    first = np.arange((columns + 1) * rows).reshape(rows, columns + 1)[:, :-1].ravel()
    quads = np.stack([first, first + 1, first + columns + 2, first + columns + 1], axis=-1)
    return np.stack([x.ravel(), y.ravel()], axis=-1), quads


def ring_layout(rng):
    sectors, rings = int(rng.integers(3, 7)), int(rng.integers(1, 3))
    angle = 2.0 * np.pi / sectors * np.arange(sectors)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    vertices = np.concatenate([(1.0 + k) * circle for k in range(rings + 1)])
    k, j = np.arange(sectors), (np.arange(sectors) + 1) % sectors
    ring = np.stack([k, sectors + k, sectors + j, j], axis=-1)
    return vertices, np.concatenate([ring + sectors * r for r in range(rings)])


def disc_layout(rng):
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / np.sqrt(2.0)
    ring = [(k, 4 + k, 4 + (k + 1) % 4, (k + 1) % 4) for k in range(4)]
    return np.concatenate([rng.uniform(0.3, 0.7) * corners, corners]), np.array([(0, 1, 2, 3), *ring])


def star_layout(rng):
    arms = int(rng.integers(3, 7))
    angle = np.pi / arms * np.arange(2 * arms)
    radius = np.where(np.arange(2 * arms) % 2, 1.4, 1.0)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    quads = [(0, 1 + k, 2 + k, 1 + (k + 2) % (2 * arms)) for k in range(0, 2 * arms, 2)]
    return np.concatenate([np.zeros((1, 2)), vertices]), np.array(quads)


LAYOUTS = (grid_layout, ring_layout, disc_layout, star_layout)


def random_grading(rng, length, count):
    """A grading; those that depend on length and count mostly fit an edge of that length and count."""
    skewed = rng.uniform(-0.9, 0.9)
    listed = count if rng.random() < 0.9 else count + 1
    kinds = (
        lambda: Uniform(),
        lambda: Quadratic(rng.uniform(-0.95, 0.95)),
        lambda: Cubic(rng.uniform(0.0, 0.95)),
        lambda: Exponential(rng.uniform(0.5, 3.0)),
        lambda: Geometric(total=10.0 ** rng.uniform(-2.0, 2.0)),
        lambda: Tanh(rng.uniform(0.2, 3.0), str(rng.choice(["first", "second", "both"]))),
        lambda: Cosine(str(rng.choice(["first", "second", "both"]))),
        lambda: Function(lambda t: t + skewed * t * (1.0 - t)),
        lambda: Listed(tuple(np.concatenate([[0.0], np.sort(rng.random(listed - 1)), [1.0]]))),
    )
    if count > 1:
        kinds += (
            lambda: TanhSpacing(first=rng.uniform(0.01, 1.0) / (count + 1), unit="fraction"),
            lambda: BoundaryLayer(length / count * 10.0 ** rng.uniform(-1.5, 0.0)),
        )
    return kinds[rng.integers(len(kinds))]()


def random_curve(rng, first, second, height, edge_count):
    """A curve between two places that leaves their chord by about ``height`` times its length."""
    chord = second - first
    normal = np.array([-chord[1], chord[0]])
    a, k = rng.uniform(-1.0, 1.0), int(rng.integers(2, 5))

    def bump(t):
        return first + t[:, None] * chord + height * np.sin(np.pi * t)[:, None] * normal

    def wave(t):
        return bump(t) + a * height * np.sin(k * np.pi * t)[:, None] * normal

    def uneven(t):
        return bump(t + 0.8 * a * t * (1.0 - t))

    def loop(t):
        return bump(t) + 3.0 * height * np.sin(2.0 * np.pi * t)[:, None] * chord

    def arc():
        return Arc.through(first, first + 0.5 * chord + height * normal, second)

    def nodal():
        order, count = int(rng.integers(1, 6)), edge_count if rng.random() < 0.9 else edge_count + 1
        inner = (gauss_lobatto(order)[:-1] + 1.0) / 2.0
        t = np.append(((np.arange(count)[:, None] + inner) / count).ravel(), 1.0)
        return NodalCurve(wave(t), order)

    def control(count):
        t = np.linspace(0.0, 1.0, count)
        points = wave(t)
        points[1:-1] += 0.2 * height * rng.uniform(-1.0, 1.0, (count - 2, 2)) * np.hypot(*chord)
        points[[0, -1]] = first, second
        return points

    def ellipse():
        length, angle = np.hypot(*chord), np.arctan2(chord[1], chord[0])
        radii = 0.5 * length, max(abs(height), 1e-2) * length
        center = 0.5 * (first + second)
        return Ellipse(tuple(center), radii, angle, np.pi, -np.pi if height > 0 else np.pi)

    def isoline():
        unit, across = chord / (chord @ chord), normal / (normal @ normal)

        def level(points):
            s = (points - first) @ unit
            return (points - first) @ across - height * np.sin(np.pi * s)

        return LevelSet(level, tuple(first), tuple(second), reach=1.2 * abs(height) + 0.1)

    kinds = {
        "arc": arc,
        "nodal": nodal,
        "bump": lambda: Parametric(bump),
        "wave": lambda: Parametric(wave),
        "uneven": lambda: Parametric(uneven),
        "loop": lambda: Parametric(loop),
        "by length": lambda: ArcLength(Parametric(wave)),
        "Bézier": lambda: Bezier(control(int(rng.integers(2, 6)))),
        "rational": lambda: Bezier(control(3), rng.uniform(0.5, 2.0, 3)),
        "B-spline": lambda: BSpline(control(6)),
        "NURBS": lambda: Nurbs(control(5), rng.uniform(0.5, 2.0, 5), degree=2),
        "ellipse": ellipse,
        "Lagrange": lambda: LagrangeEdge(control(int(rng.integers(2, 7)))),
        "isoline": isoline,
        "polyline": lambda: Polyline(control(int(rng.integers(3, 7)))),
        "spline": lambda: Spline(control(int(rng.integers(4, 8)))),
    }
    names = [name for name in kinds if name != "arc" or abs(height) > 1e-3]
    return kinds[names[rng.integers(len(names))]]()


def random_structure(rng):
    """A structure from mild to hopeless; may raise any of the library's errors."""
    vertices, quads = LAYOUTS[rng.integers(len(LAYOUTS))](rng)
    vertices = vertices + rng.choice([0.0, 0.05, 0.15, 0.3]) * rng.uniform(-1.0, 1.0, vertices.shape)
    vertices = vertices * [1.0, rng.choice([1.0, 1.0, 0.1, 1e-3])]
    turn = rng.uniform(0.0, 2.0 * np.pi)
    vertices = vertices @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    vertices = (vertices + rng.choice([0.0, 0.0, 100.0])) * rng.choice([1.0, 1.0, 1e-6, 1e6])
    number = rng.permutation(len(vertices))
    shuffled = np.empty_like(vertices)
    shuffled[number] = vertices
    quads = np.array([np.roll(number[quad], rng.integers(4)) for quad in rng.permutation(quads)])
    chains = BlockStructure.build(shuffled, quads).topology
    counts, gradings, curves = {}, {}, {}
    count_of_chain = rng.integers(1, 4, len(chains.edges))
    for chain in np.unique(chains.chains):
        edge = rng.permutation(chains.edges[np.flatnonzero(chains.chains == chain)[0]])
        counts[tuple(map(int, edge))] = int(count_of_chain[chain])
    graded, curved = rng.choice([0.0, 0.3, 1.0]), rng.choice([0.0, 0.3, 0.8])
    bend = rng.choice([0.03, 0.1, 0.3, 0.8])
    for pair, chain in zip(chains.edges, chains.chains, strict=True):
        first, second = map(int, rng.permutation(pair))
        count = int(count_of_chain[chain])
        length = float(np.hypot(*(shuffled[second] - shuffled[first])))
        if rng.random() < graded:
            gradings[first, second] = random_grading(rng, length, count)
        if rng.random() < curved:
            height = bend * rng.uniform(-1.0, 1.0)
            curves[first, second] = random_curve(rng, shuffled[first], shuffled[second], height, count)
    return BlockStructure.build(shuffled, quads, counts=counts, gradings=gradings, curves=curves)


def det_at(coordinates, order, xi, eta):
    """det J (e, η, ξ) of elements (e, n, 2) on a tensor grid, by another way than that of the certificate."""
    nodes, n = gauss_lobatto(order), order + 1
    x = (coordinates - coordinates[:, :1]).reshape(-1, n, n, 2).transpose(3, 0, 1, 2)
    x_xi = lagrange(nodes, eta) @ (x @ lagrange_derivative(nodes, xi).T)
    x_eta = lagrange_derivative(nodes, eta) @ (x @ lagrange(nodes, xi).T)
    return x_xi[0] * x_eta[1] - x_xi[1] * x_eta[0]


def minimum_near(coordinates, order, xi, eta, width):
    """Smallest det J of one element near a place: a grid that closes in on its own smallest value."""
    best = np.inf
    for _ in range(8):
        u, v = (np.clip(c + width * np.linspace(-1.0, 1.0, 7), -1.0, 1.0) for c in (xi, eta))
        values = det_at(coordinates[None], order, u, v)[0]
        row, column = np.unravel_index(values.argmin(), values.shape)
        best, xi, eta, width = min(best, values[row, column]), u[column], v[row], 0.4 * width
    return best


@dataclass
class Record:
    """What happened."""

    outcomes: Counter = field(default_factory=Counter)
    elements: Counter = field(default_factory=Counter)
    lies: list = field(default_factory=list)
    abstentions: list = field(default_factory=list)
    nameless: list = field(default_factory=list)


def examine(mesh, certificate, seed, record):
    """Compare the certificate of each element with dense samples and a search from the worst of them."""
    s = np.linspace(-1.0, 1.0, SAMPLES)
    coordinates = mesh.coordinates
    sampled = det_at(coordinates, mesh.order, s, s).reshape(len(coordinates), -1)
    smallest = sampled.min(axis=1)
    scale = np.abs(sampled).max(axis=1)
    valid, invalid = certificate.status == VALID, certificate.status == INVALID
    lies = (valid & (smallest <= 0.0)) | (smallest < certificate.lower) | (sampled.max(axis=1) > certificate.upper)
    # An element that is called invalid may be so between the samples, but not where they are all clearly positive.
    lies |= invalid & (smallest > 0.2 * scale)
    doubtful = np.flatnonzero(valid)[np.argsort((smallest / scale)[valid])[:2]]
    for element in doubtful:
        row, column = divmod(int(sampled[element].argmin()), SAMPLES)
        least = minimum_near(coordinates[element], mesh.order, s[column], s[row], 2.0 / (SAMPLES - 1))
        lies[element] |= least <= 0.0 or least < certificate.lower[element]
    record.lies += [(seed, int(element)) for element in np.flatnonzero(lies)]
    open_clear = (certificate.status == UNDECIDED) & (np.abs(smallest) > 1e-6 * scale)
    record.abstentions += [(seed, int(element)) for element in np.flatnonzero(open_clear)]
    for name, number in certificate.counts.items():
        record.elements[name] += number


def study(seeds):
    record = Record()
    for seed in seeds:
        rng = np.random.default_rng([7301, seed])
        order = int(rng.integers(1, 9))
        try:
            structure = random_structure(rng)
            mesh = generate(structure, order, check=False)
        except HoblockError as error:
            record.outcomes[type(error).__name__] += 1
            if not PLACE.search(str(error)):
                record.nameless.append((seed, str(error)))
            continue
        certificate = certify(mesh)
        examine(mesh, certificate, seed, record)
        record.outcomes[certificate.verdict] += 1
        if not certificate.valid:
            with pytest.raises(
                InvalidMeshError, match=r"Worst: element \d+ in block.*\(x, y\) = .*\. [A-Z].*\."
            ) as caught:
                raise_if_invalid(mesh, structure)
            assert caught.value.elements[0].status == certificate.verdict
    return record


def check(record, count):
    assert record.lies == []
    assert record.nameless == []
    assert sum(record.outcomes.values()) == count
    assert record.outcomes["valid"] > 0.15 * count
    assert record.outcomes["invalid"] > 0.1 * count
    assert len(record.abstentions) <= 1e-4 * sum(record.elements.values())


def test_some_random_structures():
    check(study(range(100)), 100)


@pytest.mark.verification
def test_ten_thousand_random_structures():
    record = study(range(10_000))
    check(record, 10_000)
    assert record.elements["undecided"] < 1e-3 * sum(record.elements.values())
