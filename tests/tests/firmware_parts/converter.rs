//! The converter's bookkeeping: rates, means, and the ring that is read in step with its triggers.

use firmware::oversampling::{middle, plan, sample};
use firmware::ports::FULL_SCALE;
use firmware::ring::{RingReader, Trouble};
use shared::units::Code;

#[test]
fn usual_rates_are_met_exactly_within_the_converters_limit() {
    for rate_hz in [100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0_f32] {
        let plan = plan(rate_hz, 84_000_000, 40_000);
        let made_hz = 84e6 / f64::from(plan.ticks * plan.per_sample);
        assert_eq!(made_hz, f64::from(rate_hz), "{plan:?}");
        assert!(plan.ticks <= 0x1_0000 && plan.ticks >= 2100 && plan.per_sample >= 4, "{plan:?}");
    }
    assert_eq!(plan(1000.0, 84_000_000, 40_000).per_sample, 32);
}

/// The best that a timer of 16 bits can do for a rate: its error, as a share, over every plan there is.
fn least_error(rate_hz: f64) -> f64 {
    let mut least = f64::INFINITY;
    for per_sample in [4.0, 8.0, 16.0, 32.0, 64.0] {
        // The converter takes four conversions at the highest rate.
        if per_sample > 4.0 && per_sample * rate_hz > 40_000.0 {
            continue;
        }
        let exact = 84e6 / (per_sample * rate_hz);
        for ticks in [exact.floor(), exact.ceil()] {
            if (1.0..=65_536.0).contains(&ticks) {
                least = least.min((84e6 / (per_sample * ticks) / rate_hz - 1.0).abs());
            }
        }
    }
    least
}

#[test]
fn every_rate_is_made_exactly_or_as_near_as_the_crystal_or_the_timer_allows() {
    let mut n_exact = 0;
    for rate in 50..=10_000_u32 {
        let rate_hz = f64::from(rate);
        let plan = plan(rate as f32, 84_000_000, 40_000);
        assert!((1..=65_536).contains(&plan.ticks) && (4..=64).contains(&plan.per_sample), "{rate} Hz: {plan:?}");
        let conversions_per_s = 84e6 / f64::from(plan.ticks);
        assert!(conversions_per_s <= 40_010.0, "{rate} Hz: {conversions_per_s} conversions/s");
        let made_hz = conversions_per_s / f64::from(plan.per_sample);
        let error = (made_hz / rate_hz - 1.0).abs();
        let least = least_error(rate_hz);
        n_exact += u32::from(error == 0.0);
        assert!(error <= f64::max(50e-6, least * 1.000_001), "{rate} Hz: {made_hz}");
        assert!(least > 0.0 || error == 0.0, "{rate} Hz can be made exactly, not as {made_hz}");
        let told_hz = f64::from(plan.rate_hz(84_000_000));
        assert!((told_hz / made_hz - 1.0).abs() < 1e-7, "{rate} Hz: told {told_hz}, made {made_hz}");
        // What is told and stored makes the same plan again.
        assert_eq!(
            firmware::oversampling::plan(told_hz as f32, 84_000_000, 40_000).rate_hz(84_000_000),
            told_hz as f32
        );
    }
    println!("{n_exact} of 9951 rates are exact");
}

#[test]
fn a_sample_is_the_mean_of_its_conversions_on_the_firmwares_scale() {
    assert_eq!(sample([4095; 32].into_iter()), Code(FULL_SCALE));
    assert_eq!(sample([0; 4].into_iter()), Code(0));
    assert_eq!(sample([1000, 1000, 1000, 1001].into_iter()), Code(4001));
}

#[test]
fn the_ring_is_read_in_step_with_its_triggers_over_their_wrap() {
    let mut reader = RingReader::<2048>::new(32);
    let mut n_samples = 0;
    let mut triggers = 0_u32;
    for step in 0..10_000 {
        triggers += 7 + step % 90;
        let ready = reader.ready(triggers, (triggers - 2) % 2048).unwrap();
        for _ in 0..ready / 32 {
            assert_eq!(reader.place(0), n_samples * 32 % 2048);
            reader.advance();
            n_samples += 1;
        }
    }
    assert_eq!(n_samples as u32, (triggers - 2) / 32);
}

#[test]
fn an_overtaken_reader_skips_whole_samples_and_keeps_the_grid() {
    let mut reader = RingReader::<2048>::new(32);
    // Half a second without the processor, as during an erase: 16,010 triggers.
    assert_eq!(reader.ready(16_010, 16_010 % 2048), Err(Trouble::Overtaken));
    assert_eq!(reader.skip_to(16_010), 501);
    assert_eq!(reader.ready(16_010, 16_010 % 2048), Ok(0));
    assert_eq!(reader.ready(16_064, 16_064 % 2048), Ok(32));
    assert_eq!(reader.place(0), 16_032 % 2048);
}

#[test]
fn a_reader_that_was_overtaken_gives_up_only_what_it_has_to() {
    // At most so many samples, and no more than the ring still holds behind a quarter that is left to the converter.
    for (per_sample, most, first_kept) in [(32, 32, 14_976), (4, 32, 15_872), (64, 32, 14_464), (64, 4, 15_744)] {
        let mut reader = RingReader::<2048>::new(per_sample);
        assert_eq!(reader.ready(16_000, 16_000 % 2048), Err(Trouble::Overtaken));
        assert_eq!(reader.skip_overtaken(16_000, most) * per_sample, first_kept, "{per_sample} a sample, {most}");
        assert_eq!(reader.place(0), first_kept as usize % 2048);
        assert_eq!(reader.ready(16_000, 16_000 % 2048), Ok(16_000 - first_kept));
    }
}

#[test]
fn a_sample_that_the_converter_wrote_over_while_it_was_being_read_is_noticed() {
    let mut reader = RingReader::<2048>::new(32);
    (0..5).for_each(|_| reader.advance());
    // The next one begins with conversion 160; the 2048th after it goes to the same place.
    assert_eq!(
        [200, 2207, 2208, 2209, 16_000].map(|triggers| reader.is_whole(triggers)),
        [true, true, true, false, false]
    );
}

#[test]
fn a_converter_that_stopped_is_noticed_and_started_again_on_the_grid() {
    let mut reader = RingReader::<2048>::new(32);
    assert_eq!(reader.ready(500, 100), Err(Trouble::Stalled));
    reader.restarted(500);
    assert_eq!(reader.skip_to(500), 16);
    assert_eq!(reader.ready(544, 44), Ok(32));
    assert_eq!(reader.place(0), 12);
}

#[test]
fn of_counts_the_one_in_the_middle_is_the_sample() {
    assert_eq!(middle([65_533, 65_534, 65_535, 0].into_iter()), Code(65_535));
    assert_eq!(middle([7].into_iter()), Code(7));
}
