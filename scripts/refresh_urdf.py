"""Refresh what follows from the hand-written part of urdf/hydrolek.urdf.

The right arm is written by hand. From it this script derives

- centre of mass and inertia of each of its links: a solid of uniform density in the form of the link's
  visual shapes, scaled to the link's mass (overlaps count twice, which only shifts weight to the joints);
- the left arm: the mirror image of the right about the plane between the arms.

With `--check` nothing is written; the exit status is 1 if the file is out of date.
"""

import argparse
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.tree import RotationalInertia, SpatialInertia, UnitInertia

from hydrolek_drake.files import write_whole

URDF = Path(__file__).resolve().parent.parent / "urdf" / "hydrolek.urdf"


def refresh(text: str) -> str:
    """The URDF's text with inertias and left arm brought up to date."""
    begin, end = "<!-- begin right arm -->", "<!-- end right arm -->"
    before, rest = text.split(begin)
    arm, rest = rest.split(end)
    between, rest = rest.split("<!-- begin left arm -->")
    _, after = rest.split("<!-- end left arm -->")
    arm = re.sub(
        r'<link name="right_\w+">.*?</link>', lambda link: _with_inertia(link.group()), arm, flags=re.S
    )
    left = _mirrored(arm)
    return f"{before}{begin}{arm}{end}{between}<!-- begin left arm -->{left}<!-- end left arm -->{after}"


def spatial_inertia(link: ElementTree.Element, mass: float) -> SpatialInertia:
    """Inertia of a link about its origin: its visual shapes filled with one density."""
    first, *others = [_solid(visual) for visual in link.iter("visual")]
    for shape in others:
        first += shape
    return SpatialInertia(mass, first.get_com(), first.get_unit_inertia())


def _solid(visual: ElementTree.Element) -> SpatialInertia:
    """Inertia of one shape about the link's origin with density 1."""
    geometry = visual.find("geometry")
    assert geometry is not None
    shape = geometry[0]
    if shape.tag == "box":
        sides = _numbers(shape.attrib["size"])
        volume = float(np.prod(sides))
        unit = UnitInertia.SolidBox(*sides)
    else:
        radius, length = float(shape.attrib["radius"]), float(shape.attrib["length"])
        volume = np.pi * radius**2 * length
        unit = UnitInertia.SolidCylinder(radius, length, [0, 0, 1])
    origin = visual.find("origin")
    attributes = {} if origin is None else origin.attrib
    pose = RigidTransform(
        RollPitchYaw(_numbers(attributes.get("rpy", "0 0 0"))), _numbers(attributes.get("xyz", "0 0 0"))
    )
    about_centre = SpatialInertia(volume, np.zeros(3), unit).ReExpress(pose.rotation())
    return about_centre.Shift(-pose.translation())


def _with_inertia(link_text: str) -> str:
    link = ElementTree.fromstring(link_text)
    mass_element = link.find("inertial/mass")
    if mass_element is None:
        return link_text
    inertia = spatial_inertia(link, float(mass_element.attrib["value"]))
    centre = inertia.get_com()
    central: RotationalInertia = inertia.Shift(centre).CalcRotationalInertia()
    moments, products = central.get_moments(), central.get_products()
    if abs(centre[2]) > 1e-12 or np.abs(products[1:]).max() > 1e-12:
        sys.exit(f"{URDF.name}: link {link.attrib['name']} is not symmetric about z = 0; mirror its shapes")
    values = dict(zip(("ixx", "iyy", "izz", "ixy"), [*moments, products[0]], strict=True))
    fresh = " ".join(
        f'{key}="{values.get(key, 0.0):.9g}"' for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    head, tail = link_text.split("</inertial>", 1)
    head = re.sub(r'<origin xyz="[^"]*"/>', f'<origin xyz="{centre[0]:.9g} {centre[1]:.9g} 0"/>', head)
    head = re.sub(r"<inertia .*?/>", f"<inertia {fresh}/>", head)
    return f"{head}</inertial>{tail}"


def _mirrored(arm: str) -> str:
    """The left arm's text: names, the base's lateral position, joint 1's range, off-plane shapes."""
    left = arm.replace("right_", "left_").replace('xyz="0.15 -0.30 0.15"', 'xyz="0.15 0.30 0.15"')
    lower, upper = re.findall(r'<limit lower="([^"]+)" upper="([^"]+)"', left)[0]
    left = left.replace(
        f'lower="{lower}" upper="{upper}"', f'lower="{_negated(upper)}" upper="{_negated(lower)}"', 1
    )
    # the moving links are symmetric about z = 0; only the base carries a foot on one side
    base_end = left.index("</link>")
    base = re.sub(
        r'(<visual><origin xyz="\S+ \S+ )(\S+?)"',
        lambda m: f'{m.group(1)}{_negated(m.group(2))}"',
        left[:base_end],
    )
    return base + left[base_end:]


def _negated(number: str) -> str:
    return number if float(number) == 0 else number[1:] if number.startswith("-") else "-" + number


def _numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="only say whether the file is up to date")
    check = parser.parse_args().check
    text = URDF.read_text()
    fresh = refresh(text)
    if check:
        sys.exit(0 if fresh == text else f"{URDF.name} is out of date; run scripts/refresh_urdf.py")
    write_whole(URDF, fresh)


if __name__ == "__main__":
    main()
