#!/usr/bin/env python3
"""symmetric_arm.py [--write]: the planar arms of this folder with the kinetic energy to first order in the elastic
coordinates, T = ½ uᵀ(M₀ + M₁)u, and Lagrange's equations of it, by explicit Jacobians and complex steps; asks for numpy.

It takes nothing from the engine. Its untruncated equations are held against the golden data that are there; then it
prints how far those of `symmetric` are, or with --write puts them in: `symmetric` and `symmetric-linear`.
"""
import json
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).parent
STEP = 1e-30
LENGTH, EI = 0.9144, (112.106, 14.0133)
DENSITY = (1.33937, 0.669685)


def clamped_free(n, x):
    """Values and slopes of mode n at x [m], with ∫φ² = L; and β."""
    guess = (n - 0.5) * np.pi if n > 1 else 1.8751
    b = guess
    for _ in range(50):
        f, df = np.cos(b) + 1 / np.cosh(b), -np.sin(b) - np.sinh(b) / np.cosh(b) ** 2
        b -= f / df
    e, xi = np.exp(-b), x / LENGTH
    d, g = 1 - e * e + 2 * e * np.sin(b), e + np.cos(b) - np.sin(b)
    grow, fall = np.exp(-b * (1 - xi)), np.exp(-b * (1 + xi))
    value = np.exp(-b * xi) - np.cos(b * xi) + (1 + 2 * e * g / d) * np.sin(b * xi) - g / d * (grow - fall)
    slope = -np.exp(-b * xi) + np.sin(b * xi) + (1 + 2 * e * g / d) * np.cos(b * xi) - g / d * (grow + fall)
    return value, slope * b / LENGTH, b / LENGTH


class Beam:
    """Quadrature of one link: places, φ, and foreshortening −½ qᵀ(∫φ′φ′)q up to each."""

    def __init__(self, link, modes, panels=120):
        nodes, weights = np.polynomial.legendre.leggauss(10)
        edges = np.linspace(0, LENGTH, panels + 1)
        h = LENGTH / panels
        self.x = (edges[:-1, None] + h * (nodes + 1) / 2).ravel()
        self.mass = np.tile(weights * h / 2, panels) * DENSITY[link]
        self.modes = modes
        of = lambda x: np.array([clamped_free(n, x)[:2] for n in range(1, modes + 1)])  # mode, value or slope, place
        self.phi = of(self.x)[:, 0]
        # ∫φ′φ′ from the panel's edge to each node, and over whole panels before it
        inner = []
        for edge in edges[:-1]:
            row = []
            for node in np.append(nodes, 1.0):
                part = h * (node + 1) / 2
                s = of(edge + part * (nodes + 1) / 2)[:, 1]
                row.append(np.einsum("ik,jk,k->ij", s, s, weights * part / 2))
            inner.append(row)
        inner = np.array(inner)
        before = np.concatenate([np.zeros((1, modes, modes)), np.cumsum(inner[:, -1], axis=0)])
        self.gamma = -(before[:-1, None] + inner[:, :-1]).reshape(-1, modes, modes)
        end = of(np.array([LENGTH]))
        self.tip = (end[:, 0, 0], end[:, 1, 0], -before[-1])
        betas = np.array([clamped_free(n, self.x)[2] for n in range(1, modes + 1)])
        self.stiffness = EI[link] * LENGTH * betas**4


class Arm:
    """Coordinates: shoulder, modes of link 1, elbow, modes of link 2."""

    def __init__(self, modes):
        self.beams = [Beam(0, modes), Beam(1, modes)]
        self.modes, self.n = modes, 2 + 2 * modes
        self.slots = [slice(1, 1 + modes), slice(2 + modes, 2 + 2 * modes)]

    def mass(self, s, second_order=True):
        """M(s) = Σ m JᵀJ, for complex s too."""
        n, M = self.n, np.zeros((self.n, self.n), complex)
        turn = lambda a: np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
        quarter = np.array([[0, -1], [1, 0]])

        def add(m, J):
            nonlocal M
            M = M + m * J.T @ J

        def rigid(p, Jp, a, Ja, m, x, I):
            r = turn(a) @ np.array([x, 0])
            add(m, Jp + np.outer(quarter @ r, Ja))
            add(I, Ja[None, :])
            return p + r, Jp + np.outer(quarter @ r, Ja)

        p, Jp = np.zeros(2, complex), np.zeros((2, n), complex)
        angle, Ja = s[0] + 0j, np.zeros(n, complex)
        Ja[0] = 1
        rigid(p, Jp, angle, Ja, 20.0, 0.0, 0.01)
        offsets = (0.0762, 0.0127)
        ends = ((14.0, 0.0762, 0.03), (2.0, 0.0508, 0.01))
        for link, beam in enumerate(self.beams):
            if link == 1:
                angle, Ja = angle + s[1 + self.modes], Ja.copy()
                Ja[1 + self.modes] = 1
            R, q = turn(angle), s[self.slots[link]]
            root = R @ np.array([offsets[link], 0])
            p, Jp = p + root, Jp + np.outer(quarter @ root, Ja)

            def section(x, phi, gamma):
                g = gamma @ q if second_order else 0 * q
                local = np.array([x + 0.5 * q @ g, phi @ q])
                J = Jp + np.outer(quarter @ (R @ local), Ja)
                J[:, self.slots[link]] += R @ np.array([g, phi + 0j])
                return p + R @ local, J

            for x, m, phi, gamma in zip(beam.x, beam.mass, beam.phi.T, beam.gamma):
                add(m, section(x, phi, gamma)[1])
            phi, slope, gamma = beam.tip
            p, Jp = section(LENGTH, phi, gamma)
            angle, Ja = angle + slope @ q, Ja.copy()
            Ja[self.slots[link]] += slope
            p, Jp = rigid(p, Jp, angle, Ja, *ends[link])
        return M

    def scaled(self, s, factor):
        t = s.astype(complex)
        for slot in self.slots:
            t[slot] *= factor
        return t

    def first_order(self, s, second_order):
        """M₀ + d/dε M(x, εq)."""
        return (
            self.mass(self.scaled(s, 0), second_order).real
            + self.mass(self.scaled(s, 1j * STEP), second_order).imag / STEP
        )

    def equations(self, M, slopes, s, u):
        """Lagrange's: M and f of M u̇ = f, from M and its derivatives by the coordinates."""
        rate = np.einsum("kij,k->ij", slopes, u)
        f = 0.5 * np.einsum("kij,i,j->k", slopes, u, u) - rate @ u
        for slot, beam in zip(self.slots, self.beams):
            f[slot] -= beam.stiffness * s[slot]
        return M, f

    def untruncated(self, s, u):
        slopes = []
        for k in range(self.n):
            step = np.zeros(self.n, complex)
            step[k] = 1j * STEP
            slopes.append(self.mass(s + step).imag / STEP)
        return self.equations(self.mass(s.astype(complex)).real, np.array(slopes), s, u)

    def symmetric(self, s, u, second_order):
        slopes = np.zeros((self.n, self.n, self.n))
        for slot in self.slots:  # M₁ is linear in q
            for k in range(slot.start, slot.stop):
                step = self.scaled(s, 0)
                step[k] = 1j * STEP
                slopes[k] = self.mass(step, second_order).imag / STEP
        elbow = 1 + self.modes  # M has one harmonic of the elbow's angle: a quarter turn on either side is exact
        quarter = np.zeros(self.n)
        quarter[elbow] = np.pi / 2
        slopes[elbow] = 0.5 * (self.first_order(s + quarter, second_order) - self.first_order(s - quarter, second_order))
        return self.equations(self.first_order(s, second_order), slopes, s, u)


def vectors(state, modes):
    s, u = [], []
    for hinge, link in (("shoulder", "link1"), ("elbow", "link2")):
        s += state["hinges"][hinge]["position"] + state["bodies"][link]["modes"]
        u += state["hinges"][hinge]["rate"] + state["bodies"][link]["rates"]
    assert len(s) == 2 + 2 * modes
    return np.array(s), np.array(u)


def distance(system, expected):
    M, f = system
    size = np.sqrt(np.abs(np.outer(np.diag(M), np.diag(M))))
    return max(
        np.max(np.abs(M - np.array(expected["mass_matrix"])) / size),
        np.max(np.abs(f - np.array(expected["force"]))) / np.max(np.abs(f)),
    )


def main():
    for modes in (1, 2, 4):
        path = HERE / f"arm-{modes}.json"
        data, arm, worst, most = json.loads(path.read_text()), Arm(modes), 0.0, 0.0
        for case in data["cases"]:
            s, u = vectors(case["state"], modes)
            worst = max(worst, distance(arm.untruncated(s, u), case["expected"]["quadratic"]))
            for name, second_order in (("symmetric", True), ("symmetric-linear", False)):
                M, f = arm.symmetric(s, u, second_order)
                if "--write" in sys.argv:
                    case["expected"][name] = {
                        "accelerations": np.linalg.solve(M, f).tolist(),
                        "mass_matrix": M.tolist(),
                        "force": f.tolist(),
                    }
                most = max(most, distance((M, f), case["expected"][name]))
        print(f"arm-{modes}: untruncated {worst:.1e} of the golden data, symmetric {most:.1e}")
        if worst > 1e-10 or most > 1e-10:
            return 1
        if "--write" in sys.argv:
            path.write_text(json.dumps(data, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
