"""An even drive of a whole car as a scenario: for tests and benchmarks."""

CORNERS = ("fl", "fr", "rl", "rr")


def even_drive(seconds, rate_hz, corners, km_h=80.0):
    """The scenario's text. ``corners`` are lines of TOML by corner, or lines for all four: masses and the pressure."""
    each = corners if isinstance(corners, dict) else dict.fromkeys(CORNERS, corners)
    return f"""
name = "an even drive"
duration_s = {seconds}
rate_hz = {rate_hz}
settle_s = 5.0
wheelbase_m = 2.7
speed.constant_km_h = {km_h}
road.surface.iso8608 = {{ roughness = "B", slope = 2.1 }}
sensor.noise_m_s2 = 0.05
[car]
""" + "".join(f"[corner.{name}]\n{lines}\n" for name, lines in each.items())
