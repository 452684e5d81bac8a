"""Search for effects: screening, fits, judgement on held-out manoeuvres, and addition one by one."""
