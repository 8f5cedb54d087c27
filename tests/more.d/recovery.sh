# Fits of 500 random rigs: parameters within bounds, and how often the truth lies in the intervals; 20 minutes.
env RECOVERY_RIGS="${RECOVERY_RIGS:-500}" cargo test --locked -p tests --test recovery -- --include-ignored --nocapture
