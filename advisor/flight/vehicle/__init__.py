"""The vehicle: its senders, modes, parameters, and the surfaces that its servo outputs move."""
