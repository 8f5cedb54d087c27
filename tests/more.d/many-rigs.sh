# Fifty kills of a study, and its Snakemake workflow on 60 recordings in parts on two jobs; some minutes.
env STUDY_KILLS=50 cargo test --locked -p tests --test study -- --nocapture a_kill
cargo test --locked -p tests --test study_workflow -- --include-ignored --nocapture
