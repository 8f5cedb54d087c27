use super::*;

#[test]
fn every_effect_explains_itself() {
    for effect in Effect::<f64>::ALL {
        assert!(effect.name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
        for text in [effect.summary, effect.formula, effect.source, effect.experiment] {
            assert!(text.len() > 5, "{}: a text is missing", effect.name);
        }
        for p in effect.parameters {
            assert!(p.low < p.high && (p.low..=p.high).contains(&p.start), "{} {}", effect.name, p.symbol);
        }
    }
}

#[test]
fn fits_start_inside_the_ranges_and_first_where_the_parameters_say() {
    for effect in Effect::<f64>::ALL {
        assert!(!effect.starts.is_empty(), "{}", effect.name);
        for (i, p) in effect.parameters.iter().enumerate() {
            assert_eq!(effect.starts[0][i], p.start, "{} {}", effect.name, p.symbol);
            assert!(effect.starts.iter().all(|start| (p.low..=p.high).contains(&start[i])), "{}", effect.name);
        }
    }
}

#[test]
fn rules_speak_of_parameters_that_the_effect_has() {
    for effect in Effect::<f64>::ALL {
        let Rules { relaxes_at, must_lie_within, is_free_offset, is_calibrated, .. } = effect.rules;
        assert!(must_lie_within.is_none_or(|index| usize::from(index) < effect.parameters.len()), "{}", effect.name);
        assert!(!effect.first_look_starts().is_empty(), "{}", effect.name);
        let relaxes_at = relaxes_at.map(|index| effect.parameters[usize::from(index)].unit);
        assert!(relaxes_at.is_none_or(|unit| unit == "rad"), "{}", effect.name);
        assert!(!(is_free_offset || is_calibrated) || effect.parameters.len() == 1, "{}", effect.name);
    }
    assert_eq!(Effect::<f64>::with(|rules| rules.is_free_offset).count(), 1, "a reading has one offset");
    assert_eq!(Effect::<f64>::with(|rules| rules.is_calibrated).count(), 1, "a sensor has one gain");
}

#[test]
fn what_an_effect_generalises_exists_and_has_fewer_parameters() {
    for effect in Effect::<f64>::ALL {
        if let Some(simpler) = effect.generalises {
            let simpler = Effect::<f64>::by_name(simpler).unwrap();
            assert!(simpler.parameters.len() < effect.parameters.len(), "{}", effect.name);
        }
    }
}

#[test]
fn a_law_that_follows_its_special_case_has_the_same_numbers_first_under_symbols_of_its_own() {
    for effect in Effect::<f64>::with(|rules| rules.follows_special_case) {
        let simpler = Effect::<f64>::by_name(effect.generalises.unwrap()).unwrap();
        let same = effect.parameters.iter().zip(simpler.parameters).all(|(a, b)| a.unit == b.unit);
        assert!(same && effect.rules.special_case_at.is_some(), "{}", effect.name);
        let all = || Effect::<f64>::ALL.iter().flat_map(|effect| effect.parameters);
        let is_own = |p: &Parameter| all().filter(|other| other.symbol == p.symbol).count() == 1;
        assert!(effect.parameters.iter().all(is_own), "{}", effect.name);
    }
}

#[test]
fn names_find_their_effects_on_both_number_types() {
    for effect in Effect::<f32>::ALL {
        assert_eq!(Effect::<f64>::by_name(effect.name).unwrap().id, effect.id);
        assert_eq!(Effect::<f64>::by_id(effect.id).unwrap().name, effect.name);
    }
}
