"""Which effects are there: screened, fitted, judged on manoeuvres kept out, added one after another."""
