"""A flight of an aircraft that only its feedback keeps in the air."""

from pathlib import Path

from sim.flight import Flight
from sim.modelled import modelled_flight
from sim.scenario import Augmentation, Maneuver, Noise, Scenario

DERIVATIVES = {
    "Z_0": 0.0, "Z_alpha": -1.42, "Z_q": 0.0, "Z_delta_e": -0.2,
    "M_0": 0.0, "M_alpha": 9.64, "M_q": -3.71, "M_delta_e": -12.8,
}  # fmt: skip
"""Of the aircraft without its feedback, SI, at 120 m/s."""


def unstable_flight(folder: Path, slew_s: float, noise: Noise) -> Flight:
    """Ten seconds of smooth steps in a record that begins half a second before them."""
    path = folder / "unstable.yaml"
    path.write_text(f"airspeed_m_s: 120\nmodel: {DERIVATIVES}\n".replace("'", ""))
    scenario = Scenario(
        lead_in_s=0.0,
        settling_s=0.5,
        closing_s=0.0,
        unit_s=1.0,
        amplitude_deg=1.5,
        noise=noise,
        augmentation=Augmentation(alpha=1.2, pitch_rate=0.4),
        maneuvers=(Maneuver("multistep", slew_s=slew_s, free_s=1.0),),
    )
    return modelled_flight(scenario, path)
