"""From a plan to what the solver is given: bodies, contact law, far field, friction, load path."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from railhead.contact import closed_forms, wheelset_kinematics
from railhead.contact.solid import Contact
from railhead.meshing.bodies import BODY_NAMES, CONTACT, RAIL, SUPPORT, WHEEL
from railhead.planning.effects import interface
from railhead.planning.forecast import Zone
from railhead.planning.simulation_plan import Plan
from railhead.postprocess.findings import Frame
from railhead.scene.bodies import BodySection
from railhead.scene.scene import Scene
from railhead.solver.material import Hardening, Material
from railhead.solver.space.contact_interface import ContactLaw
from railhead.solver.system.setup import ContactBody, FrictionSettings, LoadPath, Setup
from railhead.theory.array_types import Array, Mask
from railhead.theory.elastic import halfspace

GROWTH_STEPS = 8  # load steps in which the patch of bodies of different materials grows
FORCE_STEPS = 4  # of the tangential force where bodies yield; 8 change the strain by 2 %
YIELD_REACH = 3.0  # size of the region in which yield is followed, over the patch


def setup(plan: Plan) -> Setup:
    """Input of the contact model of a plan besides its mesh: bodies, contact law, symmetry planes,
    far field, linear solver, load path and friction.
    """
    scene, contact, on = plan.scene, plan.contact, plan.effects
    has_friction = on["friction"].on
    theta = scene.solver.theta
    if on["plasticity"].on and has_friction and theta is None:  # with 1 Newton's method may swing
        theta = 0
    kinematics = contact.kinematics
    if on["mean_dilatation"].on:
        kinematics = replace(kinematics, mean_dilatation=True)
    far = on["far_field"].on  # that of a load, so the load is what is given
    made = materials(plan)
    path = LoadPath(
        steps=plan.load_steps,
        unload=scene.unload,
        near=partial(near_patches, plan.forecast.zones),
    )
    fixed, moving = (
        ContactBody(tag=tag, contact=CONTACT + tag, support=SUPPORT + tag, material=made[tag])
        for tag in (RAIL, WHEEL)
    )
    return Setup(
        fixed=fixed,
        moving=moving,
        slave=plan.slave,
        gap=plan.contact.gap(plan.slave),
        degree=plan.order,
        cut=kinematics.dim == 2,  # in a solid eight times as many points as whole facets have
        law=ContactLaw(scene.solver.method, theta, scene.solver.gamma_factor),
        planes=plan.planes,
        far_field=partial(hertz_far_field, scene, contact, made) if far else None,
        load_control=scene.load is not None or far,
        linear=scene.solver.linear,
        tolerance=plan.newton_tolerance,
        kinematics=kinematics,
        load_path=path if on["plasticity"].on else None,
        friction=_friction(plan) if has_friction else None,
    )


def materials(plan: Plan) -> dict[int, Material]:
    """Elastic constants by body tag (RAIL, WHEEL) as simulated; a body that is not meshed is rigid,
    with an infinite modulus. Where yield is simulated, hardening is set for bodies that have a
    yield stress.
    """
    made = {}
    for tag, name in BODY_NAMES.items():
        part = getattr(plan.scene, name)
        young = plan.context.young_moduli[name]
        made[tag] = Material(young, part.poisson_ratio)
        if plan.effects["plasticity"].on and part.yields and math.isfinite(young):
            made[tag] = replace(made[tag], hardening=hardening(part))
    return made


def hardening(part: BodySection) -> Hardening:
    """Flow curve (MPa) of a body that yields, and how it hardens under cycles. Raises ValueError as
    `Hardening.cyclic`.
    """
    strain, stress = zip(*part.curve, strict=True)
    share, slope = part.kinematic_fraction or 0.0, part.hardening_modulus or 0.0
    return Hardening(strain, stress, share, slope).cyclic(*part.law)


def _friction(plan: Plan) -> FrictionSettings:
    """Coefficient, axes and prescribed motion or forces of the wheel on the rail of a plan. In a
    shift, and where rolling has a force, the motion of a direction follows from the force. It is
    zero instead along the normal of a symmetry plane or of a section, and in a meridian section.
    """
    scene, contact = plan.scene, plan.contact
    frame, rolling = contact.frame, scene.rolling
    given = rolling if rolling.prescribed else scene.friction
    moves = wheelset_kinematics.creepage(plan.contact)
    known = [moves.along, moves.across, moves.spin]
    free = []
    for index, way in enumerate(("along", "across")):
        if rolling.prescribed and getattr(rolling, f"force_{way}") is None:
            continue
        known[index] = 0.0
        if index in contact.slips and not (plan.half_x, plan.half_y)[index]:
            free.append((index, float(getattr(given, f"force_{way}") or 0.0)))
    return FrictionSettings(
        coefficient=lambda points: contact.friction_coefficient(points[:, 1]),
        rolling=rolling.prescribed,
        axes=frame.axes,
        origin=frame.origin,
        rigid_slip=wheelset_kinematics.rigid_slip(contact),
        creepage=(known[0], known[1], known[2]),
        force_controlled=tuple(free),
        load_steps=friction_steps(plan),
        far_field=partial(cerruti_far_field, materials(plan)) if contact.solid_half_space else None,
        interface=closed_forms.interface(scene),
    )


def friction_steps(plan: Plan) -> tuple[tuple[float, float], ...]:
    """Steps of (share of the load, share of the tangential forces). The patch of bodies of
    different materials grows in steps if nothing rolls: after step k of n its length is sin(pi
    k/2n) of the full one. The state of stick of a step is that of its middle, so the last step is
    short. Then the force is applied, in equal steps where bodies yield.
    """
    scene, power = plan.scene, plan.contact.load_power
    grown: list[tuple[float, float]] = []
    if interface.grows(plan.context):
        angles = np.linspace(0, np.pi / 2, GROWTH_STEPS + 1)[1:]
        grown = [(float(share), 0.0) for share in np.sin(angles) ** power]
        if not any(scene.tangential_forces[1:]):
            return tuple(grown)
    steps = FORCE_STEPS if plan.effects["plasticity"].on else 1
    return (*grown, *((1.0, step / steps) for step in range(1, steps + 1)))


def near_patches(zones: Sequence[Zone], points: Array) -> Mask:
    """Mask (n,) of the points (n, 3) in space, mm, near which yield is followed: in ellipsoids
    around the patches (zones). Their half axes are three times (YIELD_REACH) the patch's half
    lengths and, in depth, three times the smaller one.
    """
    near = np.zeros(len(points), dtype=bool)
    for zone in zones:
        half = np.array([zone.a, zone.b, min(zone.a, zone.b)])
        local = Frame(zone.centre, zone.angle).local(points)
        near |= ((local / half) ** 2).sum(axis=1) < YIELD_REACH**2
    return near


def hertz_far_field(
    scene: Scene,
    contact: Contact,
    materials: dict[int, Material],
    load: float,
    body: int,
    points: Array,
) -> Array:
    """Displacement (n, 3) in space, mm, of a half-space (RAIL or WHEEL) at points (n, 3) in space,
    mm, under Hertz's pressure of a load (N). The first contact is at the origin, x runs along the
    rail, the surface is the plane z = 0.

    It is zero at infinity, of a line contact instead at the depth `LineContact.datum` under its
    middle, and everywhere in a rigid body.

    scene, contact: for the moduli and curvatures of both bodies.
    materials: elastic constants by body tag.
    """
    hertz = closed_forms.hertz_contact(scene, contact, load)
    part, (lower, mirror) = materials[body], halfspace.mirrored(points, upwards=body == WHEEL)
    return hertz.displacement(lower, part.young_modulus, part.poisson_ratio) * mirror


def cerruti_far_field(materials: dict[int, Material], way: int, body: int, points: Array) -> Array:
    """Displacement (n, 3) in space, mm, of a half-space (RAIL or WHEEL) at points (n, 3) in space,
    mm, under a tangential point force that stands for the tractions. The wheel acts on the rail
    with 1 N along +x (way 0) or +y (way 1), and the rail on the wheel with the opposite force. They
    act at the origin, the first contact; the surface is the plane z = 0.

    materials: elastic constants by body tag.
    """
    part, (lower, mirror) = materials[body], halfspace.mirrored(points, upwards=body == WHEEL)
    force = mirror[2]  # the rail's on the wheel is the opposite one
    moved = halfspace.cerruti_displacement(
        lower, force, part.young_modulus, part.poisson_ratio, across=way == 1
    )
    return moved * mirror
