"""Writes drive.log, or the log and the seconds that are given: two minutes of a made-up car on a bus with the messages of car.dbc.

Unequal tires (offsets of .13 % and less), slip of the driven front axle, bends, grades, noise of the wheels and the step of the signals. At
half of the time the rear right tire has lost a quarter of its pressure: its radius is smaller by -.007 ln .75 = .2 %.
"""

import math
import random
import sys

LOG, DURATION_S = (sys.argv[1:] + ["drive.log", "120"])[:2] if len(sys.argv) in (1, 3) else sys.exit("make.py [LOG SECONDS]")
RATE_HZ = 25
TRACK_M, WHEELBASE_M = 1.55, 2.7
OFFSETS = [1.3e-3, -0.4e-3, -0.9e-3, 0.6e-3]  # ln of the radii: front left, front right, rear left, rear right

draw = random.Random(47)
hop, lines = [0.0] * 4, []
for k in range(int(DURATION_S) * RATE_HZ):
    t = k / RATE_HZ
    speed = 18.0 + 3.0 * math.sin(t / 9.0)
    accel = 3.0 / 9.0 * math.cos(t / 9.0)
    grade = 0.15 * math.sin(t / 21.0)  # m/s^2 of gravity along the road
    bend = 1.2e-3 * math.sin(t / 7.0) + 0.6e-3 * math.sin(t / 2.3)  # 1/m
    yaw = speed * bend
    force = accel + grade + 0.12 + 4e-4 * speed**2
    outer, turn = 0.5 * (WHEELBASE_M * bend) ** 2 + 3.7e-3 * force, 0.5 * TRACK_M * bend
    ways = [outer - turn, outer + turn, -turn, turn]
    data = 0
    for i, way in enumerate(ways):
        before, hop[i] = hop[i], draw.gauss(0.0, 1.0)
        noise = 1.06e-3 * (hop[i] - before) + 5e-4 * draw.gauss(0.0, 1.0)
        radius = OFFSETS[i] + (0.007 * math.log(0.75) if i == 3 and t >= int(DURATION_S) / 2 else 0.0)
        data |= round(3.6 * speed * math.exp(way - radius + noise) / 0.03125) << (16 * i)
    data |= (k % 4) << 14
    lines.append(f"({t:.6f}) can0 386#{data.to_bytes(8, 'little').hex().upper()}")
    data = round((speed * yaw + 10.23) / 0.01) | round((accel + grade + 10.23) / 0.01) << 13
    data |= round((math.degrees(yaw) + 40.95 + draw.gauss(0.0, 0.05)) / 0.01) << 40
    lines.append(f"({t + 0.002:.6f}) can0 220#{data.to_bytes(8, 'little').hex().upper()}")

with open(LOG, "w", encoding="ascii") as log:
    log.write("\n".join(lines) + "\n")
