"""A table on a motor, which hosts command."""

TURNTABLE = """
format: withy/1
time: {end: 2, output: 0.5}
integrator: {name: dopri5, rtol: 1e-10, atol: 1e-12}
bodies: {table: {type: rigid, mass: 1, inertia: [0.1, 0.1, 0.2, 0, 0, 0]}}
hinges: {axle: {type: revolute, axis: [0, 0, 1], parent: world, child: table}}
loads: {command: {type: input, hinge: axle}}
"""
