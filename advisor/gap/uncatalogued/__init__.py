"""Laws and checks outside the catalogue of effects."""
