# Hundreds of blind rigs before the bank: nobody innocent accused, what is missing named, sizes within their intervals; half an hour.
env ROUNDS="${ROUNDS:-8}" cargo test --locked -p tests --test bank_blind -- --include-ignored --nocapture
