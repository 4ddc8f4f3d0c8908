"""WheelSoilModel against integrals over the ground, formulas of the literature, and laws."""

from __future__ import annotations

from dataclasses import replace
from math import acos, atan2, cos, exp, isclose, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from robots_core.blocks import Soil, Wheel, WheelSoilModel
from robots_core.blocks.terramechanics.soil import SOILS
from robots_core.errors import InvalidInputError
from wheel_laboratory import published

WHEEL = Wheel(radius=0.09, width=0.11)
REGOLITH, SAND = SOILS['regolith_simulant'], SOILS['dry_sand']
LOAD = 64.68  # N
INCH, POUND = 0.0254, 4.4482216  # m, N


def over_the_ground(wheel: Wheel, soil: Soil, sinkage: float, slip: float) -> tuple[float, float, float]:
    """Load, drawbar pull and torque, integrated over the ground by SciPy.

    The place on the ground is the variable, not the angle; Bekker's pressure is that of a depth; the shear
    displacement is the integral of how fast the rim slides over the soil.
    """
    r, b = wheel.radius, wheel.width
    front = sqrt(2.0 * r * sinkage - sinkage**2)
    rise = soil.rear_ratio * sinkage
    rear = -sqrt(2.0 * r * rise - rise**2)
    entry, leave = atan2(front, r - sinkage), -acos(1.0 - rise / r)
    largest = max(leave, (soil.c1 + soil.c2 * slip) * entry)

    def pressure(x: float) -> float:
        angle = atan2(x, sqrt(r**2 - x**2))
        if angle < largest:  # what stands at the same part of the way before the largest stress
            part = (angle - leave) / (largest - leave)
            angle = entry + part * (largest - entry)
        depth = max(0.0, r * cos(angle) - (r - sinkage))
        return (soil.k_c / b + soil.k_phi) * depth**soil.n

    def displacement(x: float) -> float:
        angle = atan2(x, sqrt(r**2 - x**2))
        return quad(lambda a: r * (1.0 - (1.0 - slip) * cos(a)), angle, entry)[0]

    def shear(x: float) -> float:
        way = displacement(x)
        strength = soil.cohesion + pressure(x) * tan(soil.friction)
        return (1.0 if way > 0.0 else -1.0) * strength * (1.0 - exp(-abs(way) / soil.shear_modulus))

    def slope(x: float) -> float:
        return x / sqrt(r**2 - x**2)

    def integral(f: object) -> float:
        edge = r * sin(largest)
        return sum(quad(f, *part, epsabs=1e-9, epsrel=1e-7)[0] for part in ((rear, edge), (edge, front)))

    load = b * integral(lambda x: pressure(x) + shear(x) * slope(x))
    pull = b * integral(lambda x: shear(x) - pressure(x) * slope(x))
    torque = r * b * integral(lambda x: shear(x) * sqrt(1.0 + slope(x) ** 2))
    return load, pull, torque


@pytest.mark.parametrize('soil', [REGOLITH, SAND], ids=['regolith_simulant', 'dry_sand'])
@pytest.mark.parametrize(('sinkage', 'slip'), [(0.01, 0.0), (0.02, 0.2), (0.03, 0.8), (0.02, -0.3)])
def test_forces_are_the_integrals_over_the_ground(soil: Soil, sinkage: float, slip: float) -> None:
    found = WheelSoilModel(WHEEL, soil).forces(sinkage, slip)
    expected = over_the_ground(WHEEL, soil, sinkage, slip)
    # The quadrature's error, where the stress starts from zero with an exponent that is not whole.
    np.testing.assert_allclose(
        [found.load, found.drawbar_pull, found.torque], expected, rtol=2e-4, atol=2e-4 * expected[0]
    )


@given(sinkage=st.floats(1e-4, 0.08), n=st.floats(0.5, 1.5))
def test_without_shear_the_resistance_is_bekker_s(sinkage: float, n: float) -> None:
    # M. G. Bekker's compaction resistance: the work of pressing a rut, b (k_c / b + k_phi) z^(n+1) / (n+1).
    soil = Soil(k_c=900.0, k_phi=1e6, n=n, cohesion=0.0, friction=0.0, shear_modulus=0.01, c1=0.0, c2=0.0)
    forces = WheelSoilModel(WHEEL, soil).forces(sinkage, 0.3)
    stiffness = soil.k_c / WHEEL.width + soil.k_phi
    resistance = WHEEL.width * stiffness * sinkage ** (n + 1.0) / (n + 1.0)
    assert forces.drawbar_pull == pytest.approx(-resistance, rel=1e-4)
    assert forces.torque == 0.0


def test_a_wheel_that_spins_in_place_uses_the_whole_strength() -> None:
    soil = replace(REGOLITH, shear_modulus=1e-6)
    model = WheelSoilModel(WHEEL, soil)
    entry, _, leave = model.angles(0.02, 1.0)
    theta = np.linspace(leave, entry, 20001)
    normal, shear = model.stresses(theta, 0.02, 1.0)
    np.testing.assert_allclose(shear[:-10], (soil.cohesion + normal * tan(soil.friction))[:-10], rtol=1e-3)
    torque = WHEEL.radius**2 * WHEEL.width * np.trapezoid(shear, theta)
    assert model.forces(0.02, 1.0).torque == pytest.approx(torque, rel=1e-3)


@pytest.mark.parametrize(('c1', 'c2', 'slip'), [(0.43, 0.32, 0.228), (0.18, 0.32, 0.5), (0.43, 0.32, 0.9)])
def test_the_largest_stress_is_where_wong_and_reece_put_it(c1: float, c2: float, slip: float) -> None:
    model = WheelSoilModel(WHEEL, replace(SAND, c1=c1, c2=c2))
    entry, _, leave = model.angles(0.02, slip)
    theta = np.linspace(leave, entry, 20001)
    normal, _ = model.stresses(theta, 0.02, slip)
    assert theta[normal.argmax()] / entry == pytest.approx(c1 + c2 * slip, abs=1e-3)
    assert normal[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-6 * normal.max())


def test_a_wheel_of_wong_and_reece_carries_its_load_in_any_units() -> None:
    # Their compact sand and wheel (1967), in inches and pounds: 20 psi and 2.5 lb/in^3 of Reece's formula are
    # k = (k1 + k2 b) / b^n of Bekker's. The same wheel in SI.
    n, b = 0.47, 6.0
    k = (20.0 + 2.5 * b) / b**n
    shared = {'friction': radians(33.3), 'n': n, 'c1': 0.43, 'c2': 0.32, 'k_c': 0.0}
    imperial = WheelSoilModel(
        Wheel(radius=24.7, width=b), Soil(k_phi=k, cohesion=0.1, shear_modulus=1.5, **shared)
    )
    stress = POUND / INCH**2
    metric = WheelSoilModel(
        Wheel(radius=24.7 * INCH, width=b * INCH),
        Soil(k_phi=k * stress / INCH**n, cohesion=0.1 * stress, shear_modulus=1.5 * INCH, **shared),
    )
    for slip in (0.1, 0.228, 0.5):
        depth = imperial.sinkage(2006.0, slip)
        assert metric.sinkage(2006.0 * POUND, slip) == pytest.approx(depth * INCH, rel=1e-6)
        here, there = metric.forces(depth * INCH, slip), imperial.forces(depth, slip)
        assert here.drawbar_pull == pytest.approx(there.drawbar_pull * POUND, rel=1e-6)
        assert here.torque == pytest.approx(there.torque * POUND * INCH, rel=1e-6)


def test_a_driven_wheel_behaves_as_single_wheel_tests_show_it() -> None:
    # Towed at no slip, it pulls more and sinks deeper the more it slips, and the pull levels off.
    model, slips = WheelSoilModel(WHEEL, REGOLITH), np.linspace(0.0, 0.8, 9)
    sinkage = np.array([model.sinkage(LOAD, slip) for slip in slips])
    pull, torque = np.array([(f.drawbar_pull, f.torque) for f in map(model.forces, sinkage, slips)]).T
    assert pull[0] < 0.0 < pull[1]
    for rising in (sinkage, pull, torque):
        assert (np.diff(rising) > 0.0).all()
    assert (np.diff(pull, 2) < 0.0).all()
    # Not more than friction and cohesion give to the whole contact.
    entry, _, leave = model.angles(sinkage[-1], 0.8)
    area = WHEEL.radius * WHEEL.width * (entry - leave)
    assert pull[-1] < LOAD * tan(REGOLITH.friction) + area * REGOLITH.cohesion


def test_a_published_single_wheel_test_is_reproduced_but_for_its_slip_sinkage() -> None:
    model = WheelSoilModel(published.WHEEL, published.SOIL)
    slip, pull, torque, sinkage = np.array(published.MEASURED).T
    depth = np.array([model.sinkage(published.LOAD, one) for one in slip])
    found = np.array([(f.drawbar_pull, f.torque) for f in map(model.forces, depth, slip)])
    # Of a pull of 15 N and a torque of 5 N m, over which the numbers are given in steps of 0.5 N and 0.1 N m.
    np.testing.assert_allclose(found[:, 0], pull, atol=2.5)
    np.testing.assert_allclose(found[:, 1], torque, atol=1.0)
    np.testing.assert_allclose(found[1:, 1], torque[1:], atol=0.4)
    # An exponent that does not change with slip gives half of what a wheel digs itself in by.
    np.testing.assert_allclose(1e3 * depth[:3], sinkage[:3], atol=1.5)
    assert 0.5 < 1e3 * depth[-1] / sinkage[-1] < 0.7


@settings(max_examples=50)
@given(load=st.floats(0.0, 500.0), slip=st.floats(-0.5, 0.95))
def test_the_sinkage_for_a_load_carries_it(load: float, slip: float) -> None:
    model = WheelSoilModel(WHEEL, REGOLITH)
    depth = model.sinkage(load, slip)
    assert isclose(model.forces(depth, slip).load, load, abs_tol=1e-6)
    assert model.sinkage(load + 1.0, slip) > depth


def test_a_wheel_that_stands_is_carried_by_pressure_alone() -> None:
    model = WheelSoilModel(WHEEL, SAND)
    found = model.standing(0.02)
    stiffness = SAND.k_c / WHEEL.width + SAND.k_phi
    half = sqrt(0.02 * (2 * WHEEL.radius - 0.02))
    load, _ = quad(lambda x: (sqrt(WHEEL.radius**2 - x**2) - (WHEEL.radius - 0.02)) ** SAND.n, -half, half)
    assert found.load == pytest.approx(WHEEL.width * stiffness * load, rel=1e-5)
    assert (found.drawbar_pull, found.torque) == (0.0, 0.0)


@pytest.mark.parametrize(
    ('call', 'reason'),
    [
        (lambda m: m.forces(-0.01, 0.0), r'sinkage = -0.01 m must be in \[0, 0.09\] m, the radius'),
        (lambda m: m.forces(0.1, 0.0), 'sinkage = 0.1 m'),
        (lambda m: m.forces(float('nan'), 0.0), 'sinkage = nan m'),
        (lambda m: m.forces(0.01, 1.2), r'slip = 1.2 must be in \[-1, 1\]'),
        (lambda m: m.sinkage(-1.0, 0.0), 'load = -1.0 N must be in'),
        (lambda m: m.sinkage(1e6, 0.0), 'where the wheel sinks to its hub'),
        (lambda _: Wheel(radius=0.0, width=0.1), 'radius = 0.0 m must be a finite number above 0'),
        (lambda _: replace(SAND, friction=2.0), r'friction = 2.0 rad must be a finite number in \[0, 1.5\]'),
        (lambda _: replace(SAND, c1=0.8), r'c2 = 0.32 must be a finite number in \[0, 0.2\]'),
        (lambda _: replace(SAND, cohesion=-1.0), 'cohesion = -1.0 Pa must be a finite number at least 0'),
        (lambda _: replace(SAND, n=pi * float('inf')), 'n = inf'),
    ],
)  # fmt: skip
def test_what_is_out_of_range_is_refused(call: object, reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        call(WheelSoilModel(WHEEL, SAND))  # type: ignore[operator]
