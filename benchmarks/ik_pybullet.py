#!/usr/bin/env python3
"""Inverse kinematics beside PyBullet's, on the same targets, in one run.

    python benchmarks/ik_pybullet.py [--count 10000]

Needs Python 3.11 with `pip install pybullet`. Builds and runs the example `ik_bench` of
plumbline-model, which writes the targets (places of the tip at random joint angles inside the
limits) and prints our figures; then PyBullet solves the same targets from the same start posture
the way the published NICO software does: calculateInverseKinematics with limits, ranges and rest
postures, 300 iterations, residual threshold 1e-4; then again without limits, which it may break
then. Only the call itself is timed. The residual is
the distance of PyBullet's tip at the returned angles to the target.
"""

import argparse
import csv
import json
import math
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib
from xml.etree import ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NICO = ROOT / "assets" / "robots" / "nico"
TIP = "right_palm_center"
ITERATIONS = 300
THRESHOLD = 1e-4


def our_figures(count, targets_file):
    command = ["cargo", "run", "--release", "--quiet", "-p", "plumbline-model", "--example", "ik_bench", "--"]
    command += [str(count), "--json", "--write", str(targets_file)]
    result = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    return {figures["name"]: figures for figures in json.loads(result.stdout)}


def arm_urdf(folder, tip):
    """The links from the base to the tip only, without shapes: PyBullet computes with every joint
    that a body has, so whatever does not move the tip would only cost it time."""
    robot = ElementTree.parse(NICO / "nico.urdf").getroot()
    above = {joint.find("child").get("link"): joint for joint in robot.iter("joint") if joint.find("child") is not None}
    joints, link = [], tip
    while link in above:
        joints.append(above[link])
        link = above[link].find("parent").get("link")
    links = {link} | {joint.find("child").get("link") for joint in joints}
    for part in list(robot):
        if part.tag == "material" or (part.tag == "link" and part.get("name") not in links):
            robot.remove(part)
        elif part.tag == "joint" and part not in joints:
            robot.remove(part)
    for part in robot.iter("link"):
        for shape in part.findall("visual") + part.findall("collision"):
            part.remove(shape)
        if part.find("inertial") is None:
            # Spares a warning; mass plays no part in kinematics.
            part.append(ElementTree.fromstring('<inertial><mass value="1e-6"/><inertia ixx="1e-9" ixy="0" ixz="0" iyy="1e-9" iyz="0" izz="1e-9"/></inertial>'))
    file = folder / "arm.urdf"
    ElementTree.ElementTree(robot).write(file)
    return file


class PyBulletArm:
    def __init__(self, urdf, tip):
        import pybullet

        self.bullet = pybullet
        pybullet.connect(pybullet.DIRECT)
        self.body = pybullet.loadURDF(str(urdf), useFixedBase=True)
        infos = [pybullet.getJointInfo(self.body, i) for i in range(pybullet.getNumJoints(self.body))]
        self.tip = next(i[0] for i in infos if i[12].decode() == tip)
        moving = [i for i in infos if i[2] == pybullet.JOINT_REVOLUTE]
        self.joints = [i[0] for i in moving]
        names = [i[1].decode() for i in moving]
        rig = tomllib.loads((NICO / "rig.toml").read_text())
        limits = {i[1].decode(): (i[8], i[9]) for i in moving}
        for servo in rig["servo"]:
            sign = 1.0 if servo["direction"] == "direct" else -1.0
            ends = [(sign * servo[end] - servo["offset_rad"]) / servo["ratio"]
                    for end in ("motor_lower_rad", "motor_upper_rad")]
            if servo["joint"] not in limits:
                continue
            lower, upper = limits[servo["joint"]]
            limits[servo["joint"]] = (max(lower, min(ends)), min(upper, max(ends)))
        self.lower = [limits[name][0] for name in names]
        self.upper = [limits[name][1] for name in names]
        self.ranges = [u - l for l, u in zip(self.lower, self.upper)]
        self.rest = [0.5 * (u + l) for l, u in zip(self.lower, self.upper)]
        home = rig["pose"][0]["joints_rad"]
        self.home = [home.get(name, 0.0) for name in names]

    def set(self, angles):
        for joint, angle in zip(self.joints, angles):
            self.bullet.resetJointState(self.body, joint, angle)

    def tip_place(self):
        state = self.bullet.getLinkState(self.body, self.tip, computeForwardKinematics=True)
        return state[4], state[5]

    def solve(self, position, orientation, with_limits):
        """Seconds, position error (m), largest excess over the limits (rad)."""
        self.set(self.home)
        parts = [self.body, self.tip, position] + ([orientation] if orientation else [])
        limits = dict(lowerLimits=self.lower, upperLimits=self.upper, jointRanges=self.ranges, restPoses=self.rest)
        options = limits if with_limits else {}
        began = time.perf_counter()
        angles = self.bullet.calculateInverseKinematics(
            *parts, maxNumIterations=ITERATIONS, residualThreshold=THRESHOLD, **options)
        seconds = time.perf_counter() - began
        self.set(angles)
        reached = self.tip_place()[0]
        excess = max(max(l - a, a - u, 0.0) for a, l, u in zip(angles, self.lower, self.upper))
        return seconds, math.dist(reached, position), excess


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--count", type=int, default=10_000)
    arguments = arguments.parse_args()
    try:
        import pybullet
    except ImportError:
        sys.exit("PyBullet is missing: pip install pybullet (there are wheels for Python 3.11)")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ours = our_figures(arguments.count, folder / "targets.csv")
        with (folder / "targets.csv").open() as file:
            targets = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
        arm = PyBulletArm(arm_urdf(folder, TIP), TIP)
    print(f"{'':34} {'median µs':>10} {'mean µs':>10} {'residual: median mm':>20} {'mean mm':>12} {'largest mm':>12} {'≤ 0.1 mm':>10}")
    for case, with_limits in (("position", True), ("pose", True), ("position", False), ("pose", False)):
        rows = []
        print(f"{case}, PyBullet {'with limits and rest postures' if with_limits else 'without limits'}:")
        for target in targets:
            position = [target["x_m"], target["y_m"], target["z_m"]]
            orientation = None
            if case == "pose":
                angles = [target["roll_rad"], target["pitch_rad"], target["yaw_rad"]]
                orientation = pybullet.getQuaternionFromEuler(angles)
            rows.append(arm.solve(position, orientation, with_limits))
        seconds, errors, excess = zip(*rows)
        their_us, their_mm = statistics.median(seconds) * 1e6, statistics.median(errors) * 1e3
        share = sum(e <= 1e-4 for e in errors) / len(errors)
        print(f"{'  PyBullet':34} {their_us:10.1f} {statistics.mean(seconds) * 1e6:10.1f} {their_mm:20.3g} "
              f"{statistics.mean(errors) * 1e3:12.3g} {max(errors) * 1e3:12.3g} {100 * share:8.2f} %")
        our = ours[case]
        print(f"{'  Plumbline (always with limits)':34} {our['median_us']:10.1f} {our['mean_us']:10.1f} "
              f"{our['median_position_m'] * 1e3:20.3g} {our['mean_position_m'] * 1e3:12.3g} "
              f"{our['largest_position_m'] * 1e3:12.3g} {100 * our['reached'] / our['targets']:8.2f} %")
        print(f"{'  ratio':34} {their_us / our['median_us']:9.0f}x {statistics.mean(seconds) * 1e6 / our['mean_us']:9.0f}x "
              f"{their_mm / max(our['median_position_m'] * 1e3, 1e-12):19.3g}x "
              f"{statistics.mean(errors) / max(our['mean_position_m'], 1e-15):11.3g}x "
              f"{max(errors) / max(our['largest_position_m'], 1e-15):11.3g}x")
        beyond = sum(e > 1e-6 for e in excess)
        print(f"{'  PyBullet beyond a limit:':34} {beyond} of {len(excess)}, by up to {math.degrees(max(excess)):.2f}°")


if __name__ == "__main__":
    main()
