"""The attitude loop in Python: the controller of docs/attitude-loop.md about a simulation that it steps."""

import sys

import withy

STEP = 0.125  # s: a power of two, so that every door counts the same times
PROPORTIONAL, INTEGRAL, DERIVATIVE = 4.0, 0.2, 22.0


class Controller:
    """From attitude and rate of the bus to the torques of the motors, axis by axis."""

    def __init__(self) -> None:
        self.learned = {axis: 0.0 for axis in "xyz"}

    def command(self, axis: str, q_scalar: float, q_axis: float, rate: float) -> float:
        error = -2 * q_axis if q_scalar < 0 else 2 * q_axis  # rad, for small angles
        self.learned[axis] += INTEGRAL * STEP * error
        return PROPORTIONAL * error + self.learned[axis] + DERIVATIVE * rate


craft = withy.Simulation(withy.load(sys.argv[1]))
controller = Controller()
y = craft.outputs
print("t,qw,qx,qy,qz,tip")
for k in range(1, 961):
    for axis in "xyz":
        craft.inputs[f"motor_{axis}"] = controller.command(axis, y["float.qw"], y[f"float.q{axis}"], y[f"gyro.{axis}"])
    craft.step(STEP * k)
    shown = [craft.time, *(y[f"float.q{c}"] for c in "wxyz"), y["left_boom.tip.deflection_y"]]
    print(",".join(f"{value:.17g}" for value in shown))
