"""Objects modelled in code; each module makes one solid."""
