"""An incremental encoder. Where its shaft is comes once a millisecond, as edges of A and B counted up and down, modulo
65,536; they are not drawn one by one on the pins. Its counter is TIM4, in timers.py.
"""

from wiper import Codes


class Encoder(Codes):
    """`source(first, n)` gives the edges that were counted up to millisecond `first` and the next ones."""
