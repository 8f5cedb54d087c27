# Fifty kills of a study, 1,000 clean swings, and its Snakemake workflow on 60 recordings on two jobs; some minutes.
env STUDY_KILLS=50 STUDY_RIGS=50 cargo test --locked --test study -- --nocapture a_kill clean_swings
cargo test --locked --test study_workflow -- --include-ignored --nocapture
