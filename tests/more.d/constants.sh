# What half and twice of each tuned constant of fit and diagnosis do to forty diagnoses: docs/constants.md; hours.
# CONSTANTS picks by words of their places, as "diagnose/search.rs:BEAM fit/start".
needs python3 python3
python3 tests/constants/constants.py
