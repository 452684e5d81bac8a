"""The live link: opened, kept alive, recorded, asked."""
