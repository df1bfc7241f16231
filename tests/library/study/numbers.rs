//! Computation on numbers alone: the ascent to the best parameters, the surfaces of losses around them, ticks, cells.

mod ascent {
    use rand::RngExt;
    use tomcom_core::base::rng::stream;
    use tomcom_study::analysis::fitting::ascent::*;

    /// Measurements of 2 variables with standard deviation 1, in pairs around their means, so that the means are 0.7 of
    /// the first 100 and -1.2 of the last 24, and their standard errors are 0.1 and 0.2.
    const MEASURED: [(usize, usize, f64); 2] = [(0, 100, 0.7), (1, 24, -1.2)];

    /// Losses of single measurements where `mean` says what is expected of a variable.
    fn bowl(at: &[f64], mean: impl Fn(usize, f64) -> f64) -> Vec<f64> {
        let of = |(variable, number, centre): (usize, usize, f64)| {
            let expected = mean(variable, at[variable]);
            (0..number).map(move |index| {
                let measured = centre + if index % 2 == 0 { 1.0 } else { -1.0 };
                (measured - expected).powi(2) / 2.0
            })
        };
        MEASURED.into_iter().flat_map(of).collect()
    }

    #[test]
    fn finds_the_maximum_and_its_errors_through_noise() {
        let mut random = stream(4, "noise", 0);
        let noisy = |at: &[f64]| {
            let mut losses = bowl(at, |_, at| at);
            losses.iter_mut().for_each(|loss| *loss += 0.2 * (random.random::<f64>() - 0.5));
            Some(losses)
        };
        let found = ascend(noisy, &[3.0, 2.0], &[[-5.0, 5.0]; 2], 300);
        assert!(found.converged, "{found:?}");
        for (variable, (at, error)) in found.variables.iter().zip([(0.7, 0.1), (-1.2, 0.2)]) {
            let told = variable.standard_error.expect("an error");
            assert!((0.7 * error..2.0 * error).contains(&told), "{found:?}");
            assert!((variable.at - at).abs() < 3.0 * told && variable.end.is_none(), "{found:?}");
        }
    }

    #[test]
    fn what_has_no_maximum_gets_one_end_of_an_interval() {
        // The second variable changes nothing above -1.2, but for a small slope.
        let plateau = |at: &[f64]| {
            let mut losses = bowl(at, |variable, at| if variable == 1 { at.min(-1.2) } else { at });
            losses.push(-0.1 * at[1]);
            Some(losses)
        };
        let found = ascend(plateau, &[0.0, -2.0], &[[-5.0, 5.0], [-4.0, 3.0]], 300);
        let [first, second] = &found.variables[..] else { panic!("{found:?}") };
        assert!(found.converged && (first.at - 0.7).abs() < 0.05 && first.standard_error.is_some(), "{found:?}");
        assert_eq!((second.end, second.standard_error), (Some(BoundReached::High), None), "{found:?}");
        // 12 (-1.2 - x)^2 + 0.1 (3 - x) = 1.92 at x = -1.54.
        assert!((second.limit.expect("a limit") + 1.54).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn says_when_it_was_not_done() {
        let found = ascend(|at| Some(bowl(at, |_, at| at)), &[50.0, 50.0], &[[-1e3, 1e3]; 2], 12);
        assert!(!found.converged && found.evaluations <= 12, "{found:?}");
        assert!(found.variables.iter().all(|variable| variable.standard_error.is_none()), "{found:?}");
    }
}

mod response {
    use tomcom_study::analysis::fitting::response_surface::*;

    #[test]
    fn finds_minimum_and_curvature_of_what_is_quadratic() {
        let function = |x: &[f64]| {
            let (a, b) = (x[0] - 1.0, x[1] + 2.0);
            3.0 + 2.0 * a * a + 1.5 * b * b + a * b
        };
        let (centre, steps) = ([0.9, -2.2], [0.4, 0.3]);
        let found = surface(function, &centre, &steps).expect("a surface");
        let least = found.least(&[-REACH; 2], &[REACH; 2]);
        assert!((found.at(&least) - 3.0).abs() < 1e-9 && found.noise < 1e-9, "{found:?}");
        for (index, expected) in [1.0, -2.0].into_iter().enumerate() {
            assert!((centre[index] + least[index] * steps[index] - expected).abs() < 1e-9, "{least:?}");
        }
        // The test function has the second derivatives 4, 3, and 1 across.
        let per_step = |row: usize, column: usize| found.curvature[(row, column)] / (steps[row] * steps[column]);
        for ((row, column), expected) in [((0, 0), 4.0), ((1, 1), 3.0), ((0, 1), 1.0), ((1, 0), 1.0)] {
            assert!((per_step(row, column) - expected).abs() < 1e-9, "{found:?}");
        }
        // With slopes whose covariance is twice the curvature, variances are twice those of the observed information.
        for (share, times) in [(2.0, 2.0), (0.5, 1.0)] {
            let variances = found.variances(&(&found.curvature * share)).expect("variances");
            for (index, expected) in [3.0 / 11.0, 4.0 / 11.0].into_iter().enumerate() {
                assert!((variances[index] * steps[index].powi(2) - times * expected).abs() < 1e-9, "{variances}");
            }
        }
        assert_eq!(points(2), 11);
    }

    #[test]
    fn a_valley_has_no_covariance_and_ends_at_a_bound() {
        let valley = surface(|x| x[0] * x[0], &[0.0, 0.0], &[1.0, 1.0]).expect("a surface");
        assert!(!valley.is_convex() && valley.variances(&valley.curvature).is_none());
        let saddle = surface(|x| x[0] * x[0] - x[1] * x[1] - 0.1 * x[1], &[0.0, 0.0], &[1.0, 1.0]);
        let least = saddle.expect("a surface").least(&[-1.0, -1.0], &[1.0, 1.0]);
        assert!(least[0].abs() < 1e-9 && least[1] == 1.0, "{least:?}");
    }
}

mod scores {
    use rand::RngExt;
    use tomcom_core::base::rng::{Stream, stream};
    use tomcom_study::analysis::fitting::response_surface::{QuadraticSurface, REACH};
    use tomcom_study::analysis::fitting::score_surface::*;

    /// A number from a distribution with mean 0 and variance 1: the sum of twelve uniform numbers (Irwin and Hall).
    fn normal(random: &mut Stream) -> f64 {
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    }

    /// Losses of 400 measurements of x + y / 2 and 100 of y, with standard deviation 1, where x = 1 and y = -2.
    fn measurements(random: &mut Stream) -> impl Fn(&[f64]) -> Vec<f64> + use<> {
        let data: Vec<f64> = (0..500).map(|index| if index < 400 { 0.0 } else { -2.0 } + normal(random)).collect();
        move |at| {
            let mean = |index: usize| if index < 400 { at[0] + at[1] / 2.0 } else { at[1] };
            data.iter().enumerate().map(|(index, measured)| (measured - mean(index)).powi(2) / 2.0).collect()
        }
    }

    /// The surface of losses at the points of the design.
    fn designed(
        mut losses: impl FnMut(&[f64]) -> Option<Vec<f64>>,
        centre: &[f64],
        steps: &[f64],
    ) -> Option<QuadraticSurface> {
        let points = points_around(centre, steps);
        let tried: Vec<(Vec<f64>, Vec<f64>)> =
            points.into_iter().filter_map(|at| losses(&at).map(|losses| (at, losses))).collect();
        let tried: Vec<TriedPoint<'_>> = tried.iter().map(|(at, losses)| (at.clone(), &losses[..])).collect();
        ScoreRegression::new(&tried, centre, steps).map(|regression| regression.surface())
    }

    #[test]
    fn scores_of_measurements_give_their_information() {
        let losses = measurements(&mut stream(9943, "measurements", 0));
        let (centre, steps) = ([0.9, -1.8], [0.1, 0.2]);
        let found = designed(|at| Some(losses(at)), &centre, &steps).expect("a surface");
        let least = found.least(&[-REACH; 2], &[REACH; 2]);
        for (index, (at, error)) in [(1.0, 0.0707), (-2.0, 0.1)].into_iter().enumerate() {
            let found = centre[index] + least[index] * steps[index];
            assert!((found - at).abs() < 3.0 * error, "{found} instead of {at}");
        }
        // Information: 400 in x, 100 + 400 / 4 in y, 400 / 2 across; outer products scatter around that.
        for ((row, column), information) in [((0, 0), 400.0), ((1, 1), 200.0), ((1, 0), 200.0)] {
            let found = found.curvature[(row, column)] / (steps[row] * steps[column]);
            assert!((found / information - 1.0).abs() < 0.3, "{found} instead of {information}");
        }
        assert_eq!(points(5), 11);
    }

    #[test]
    fn noise_of_single_presses_does_not_count_as_information() {
        let mut random = stream(9943, "noise", 0);
        let mut sums = [0.0; 2];
        for _ in 0..100 {
            let losses = measurements(&mut random);
            let noisy = |random: &mut Stream, at: &[f64]| -> Vec<f64> {
                losses(at).into_iter().map(|loss| loss + 0.1 * normal(random)).collect()
            };
            let flat = designed(|_| Some((0..500).map(|_| normal(&mut random)).collect()), &[0.0; 5], &[1.0; 5]);
            sums[0] += flat.expect("a surface").curvature[(0, 0)] / 100.0;
            let told = designed(|at| Some(noisy(&mut random, at)), &[1.0, -2.0], &[0.1, 0.2]).expect("a surface");
            sums[1] += told.curvature[(0, 0)] / 100.0;
        }
        // Without a correction, the first would be 500 / 2, and the second 4 + 500 / 100 / 2.
        assert!(sums[0].abs() < 10.0 && (sums[1] - 4.0).abs() < 0.2, "{sums:?}");
    }

    #[test]
    fn a_valley_is_not_convex_and_ends_at_a_bound() {
        let valley = designed(|at| Some(vec![at[0], -at[0]]), &[0.0, 0.0], &[1.0, 1.0]).expect("a surface");
        assert!(!valley.is_convex(), "{valley:?}");
        let slope = designed(|at| Some(vec![at[0], -at[0], -0.1 * at[1]]), &[0.0, 0.0], &[1.0, 1.0]);
        let least = slope.expect("a surface").least(&[-1.0, -1.0], &[1.0, 1.0]);
        assert!(least[0].abs() < 1e-9 && least[1] == 1.0, "{least:?}");
    }

    #[test]
    fn points_without_a_likelihood_are_left_out() {
        let losses = measurements(&mut stream(9943, "measurements", 0));
        let some = |at: &[f64]| (at[0] < 0.95).then(|| losses(at));
        assert!(designed(some, &[0.9, -1.8], &[0.1, 0.2]).is_some());
        let (near, far) = (losses(&[0.9, -1.8]), losses(&[9.0, 9.0]));
        let outside = [(vec![0.9, -1.8], &near[..]), (vec![9.0, 9.0], &far[..])];
        assert!(ScoreRegression::new(&outside, &[0.9, -1.8], &[0.1, 0.2]).is_none());
        assert_eq!(designed(|_| None, &[0.9, -1.8], &[0.1, 0.2]), None);
        assert_eq!(designed(|at| Some(vec![f64::INFINITY, at[0]]), &[0.9, -1.8], &[0.1, 0.2]), None);
    }
}

mod ticks {
    use tomcom_study::charts::PlotAxis;

    fn labels(low: f64, high: f64) -> Vec<String> {
        PlotAxis::between("", low, high).ticks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn labels_of_ticks_are_not_rounded() {
        assert_eq!(labels(0.0, 12.5), ["0.0", "2.5", "5.0", "7.5", "10.0", "12.5"]);
        assert_eq!(labels(0.0, 1.25), ["0.00", "0.25", "0.50", "0.75", "1.00", "1.25"]);
        assert_eq!(labels(-100.0, 150.0), ["−100", "−50", "0", "50", "100", "150"]);
        assert_eq!(labels(0.0, 0.005), ["0.000", "0.001", "0.002", "0.003", "0.004", "0.005"]);
    }
}

mod cells {
    use tomcom_study::analysis::bids::line;

    #[test]
    fn what_somebody_typed_is_one_cell_that_no_spreadsheet_computes() {
        assert_eq!(line(["=1+1", "-0.5", "a\tb\nc", "", "@x \"y\""]), "'=1+1\t-0.5\ta b c\tn/a\t\"'@x \"\"y\"\"\"\n");
    }
}
