//! Command `tomcom power`: draws studies from a pool of simulated participants on all processors, and counts in how
//! many studies the tests find an effect. The same pool gives the same result on any number of processors.

use std::ops::Range;
use std::path::Path;

use crate::drawn_study::{DrawnEffect, PowerTest, StudySampler, tests};
use crate::parallel;
use crate::pool::SimulationPool;
use crate::power::{
    POOLS, PowerSummary, RejectionCount, STUDIES_OF_POOL, STUDIES_OF_RATIO, SampleSizeRejections, count_rejections,
    ratios,
};
use tomcom_session::files::file_error::{FileError, FileResult};

const BLOCK: u64 = 25;

/// Request of a power analysis: study sizes, number of drawn studies, and effect.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerRequest {
    pub sizes: Vec<usize>,
    pub studies: u64,
    pub effect: DrawnEffect,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Drawn {
    Pool,
    /// Studies are drawn from the bootstrap resample of the pool with this number, from 1.
    Resampled(u64),
    /// Studies are drawn from the pool, with the ratio of rates at this index.
    Ratio(usize),
}

#[derive(Clone, Debug)]
struct Block {
    size: usize,
    drawn: Drawn,
    numbers: Range<u64>,
}

/// Number of blocks of studies; [`measure`] calls `done` once for each block.
pub fn blocks(request: &PowerRequest, pool: &SimulationPool) -> u64 {
    all_blocks(request, pool).len() as u64
}

/// All blocks of studies. The least detectable effect is searched for only if the pool has unassisted twins, since only
/// then an effect of any size can be simulated.
fn all_blocks(request: &PowerRequest, pool: &SimulationPool) -> Vec<Block> {
    let split =
        |studies: u64| (0..studies.div_ceil(BLOCK)).map(move |block| block * BLOCK..((block + 1) * BLOCK).min(studies));
    let tried = if pool.header.unassisted && request.effect != DrawnEffect::Ratio(1.0) { ratios().len() } else { 0 };
    let mut blocks = Vec::new();
    for &size in &request.sizes {
        let mut add = |drawn: Drawn, studies: u64| {
            blocks.extend(split(studies).map(|numbers| Block { size, drawn, numbers }));
        };
        add(Drawn::Pool, request.studies);
        (1..=POOLS).for_each(|number| add(Drawn::Resampled(number), STUDIES_OF_POOL));
        (0..tried).for_each(|index| add(Drawn::Ratio(index), STUDIES_OF_RATIO.min(request.studies)));
    }
    blocks
}

/// Draws the studies and computes the power. `path`: file of the pool, for messages; `done` is called after each block.
///
/// # Errors
/// The pool has too few participants for an order of the conditions, or lacks the trials that the effect needs.
pub fn measure(
    request: &PowerRequest,
    pool: &SimulationPool,
    path: &Path,
    done: impl Fn() + Sync,
) -> FileResult<PowerSummary> {
    let header = &pool.header;
    let wrong = |found: String, remedy: &str| Err(FileError::from_finding(path, found, remedy.to_string()));
    match request.effect {
        DrawnEffect::AsSimulated if !header.arms => {
            return wrong(
                "a pool that has only unassisted trials".to_string(),
                "--effect RATIO, or a pool made without --null",
            );
        }
        DrawnEffect::Ratio(_) if !header.unassisted => {
            return wrong(
                "a pool without unassisted twins".to_string(),
                "a pool that tomcom power wrote, not tomcom arms",
            );
        }
        _ => {}
    }
    let source = match StudySampler::new(pool) {
        Ok(source) => source,
        Err(found) => return wrong(found, "a larger pool: two persons or more in every order of the conditions"),
    };
    let (tests, ratios) = (tests(&header.conditions), ratios());
    let blocks = all_blocks(request, pool);
    let counted = parallel::each(&blocks, |block| counts(&source, &tests, request.effect, &ratios, block), done);
    let of_size = |&size: &usize| {
        let sum = |drawn: Drawn| {
            let own = blocks.iter().zip(&counted).filter(|(block, _)| block.size == size && block.drawn == drawn);
            own.fold(vec![RejectionCount::default(); tests.len() + 1], |sum, (_, counts)| {
                sum.into_iter().zip(counts).map(|(sum, one)| sum.plus(*one)).collect()
            })
        };
        let tried = blocks.iter().filter(|block| block.size == size);
        let tried = tried.filter_map(|block| match block.drawn {
            Drawn::Ratio(index) => Some(index + 1),
            _ => None,
        });
        SampleSizeRejections {
            participants: size,
            counts: sum(Drawn::Pool),
            of_pools: (1..=POOLS).map(|number| sum(Drawn::Resampled(number))).collect(),
            of_ratios: (0..tried.max().unwrap_or(0)).map(|index| sum(Drawn::Ratio(index))).collect(),
        }
    };
    let sizes: Vec<SampleSizeRejections> = request.sizes.iter().map(of_size).collect();
    Ok(PowerSummary::new(header, request.effect, &sizes))
}

/// In how many studies of a block each test rejects its null hypothesis.
fn counts(
    source: &StudySampler,
    tests: &[PowerTest],
    effect: DrawnEffect,
    ratios: &[f64],
    block: &Block,
) -> Vec<RejectionCount> {
    let numbers = block.numbers.clone();
    match block.drawn {
        Drawn::Pool => count_rejections(source, tests, block.size, effect, numbers),
        Drawn::Resampled(number) => count_rejections(&source.resampled(number), tests, block.size, effect, numbers),
        Drawn::Ratio(index) => count_rejections(source, tests, block.size, DrawnEffect::Ratio(ratios[index]), numbers),
    }
}
