//! Files of OLE2, after [MS-CFB]: streams in chains of sectors, in which old workbooks lie.
//!
//! Whatever stands in it, a chain ends after as many sectors as there are, so that nothing takes more room than the file.

use super::little::{u16_at, u32_at, u32s};

/// So many tables of what follows what are named in the header itself.
const N_IN_HEADER: usize = 109;

/// Shorter streams lie in small sectors within the stream of the first entry.
const SMALL: usize = 4096;
const SMALL_SECTOR: usize = 64;

const ENTRY: usize = 128;
const IS_STREAM: u8 = 2;

/// The stream with the first of these names that is there.
pub(super) fn stream(bytes: &[u8], names: &[&str]) -> Option<Vec<u8>> {
    let file = File::of(bytes)?;
    let directory = file.chain(u32_at(bytes, 48)?);
    let entries = || directory.chunks_exact(ENTRY);
    let entry = names.iter().find_map(|name| entries().find(|entry| is_called(entry, name)))?;
    let (first, len) = place_of(entry)?;
    let mut stream = if len >= SMALL {
        file.chain(first)
    } else {
        let next = u32s(&file.chain(u32_at(bytes, 60)?));
        chain(&file.chain(place_of(entries().next()?)?.0), SMALL_SECTOR, &next, first)
    };
    stream.truncate(len);
    Some(stream)
}

fn is_called(entry: &[u8], name: &str) -> bool {
    let letters: Vec<u16> =
        entry[..64].chunks_exact(2).filter_map(|two| u16_at(two, 0)).take_while(|unit| *unit != 0).collect();
    entry[66] == IS_STREAM && String::from_utf16_lossy(&letters).eq_ignore_ascii_case(name)
}

/// Where its stream begins, and how long that is.
fn place_of(entry: &[u8]) -> Option<(u32, usize)> {
    Some((u32_at(entry, 116)?, u32_at(entry, 120)? as usize))
}

struct File<'a> {
    sectors: &'a [u8],
    sector_len: usize,
    /// Which sector follows on each.
    next: Vec<u32>,
}

impl<'a> File<'a> {
    fn of(bytes: &'a [u8]) -> Option<Self> {
        let sector_len = match u16_at(bytes, 30)? {
            9 => 512,
            12 => 4096,
            _ => return None,
        };
        let file = Self { sectors: bytes.get(sector_len..)?, sector_len, next: Vec::new() };
        let tables = file.tables(bytes)?;
        let next = tables.iter().map_while(|place| sector(file.sectors, sector_len, *place)).flat_map(u32s).collect();
        Some(Self { next, ..file })
    }

    /// Where the tables lie that say what follows what. The header names some, the others stand in sectors of which each
    /// ends with where the next one is.
    fn tables(&self, header: &[u8]) -> Option<Vec<u32>> {
        let n_of_sector = self.sector_len / 4;
        let n_needed = self.sectors.len().div_ceil(self.sector_len).div_ceil(n_of_sector);
        let mut places = u32s(header.get(76..76 + 4 * N_IN_HEADER)?);
        let mut more = u32_at(header, 68)?;
        while places.len() < n_needed {
            let Some(named) = sector(self.sectors, self.sector_len, more).map(u32s) else { break };
            let Some((next, named)) = named.split_last() else { break };
            places.extend(named);
            more = *next;
            if named.is_empty() {
                break;
            }
        }
        places.truncate(n_needed);
        Some(places)
    }

    fn chain(&self, first: u32) -> Vec<u8> {
        chain(self.sectors, self.sector_len, &self.next, first)
    }
}

/// The sectors of a chain, one behind the other.
fn chain(sectors: &[u8], len: usize, next: &[u32], first: u32) -> Vec<u8> {
    let mut place = Some(first);
    let places = std::iter::from_fn(|| {
        let now = place?;
        place = next.get(now as usize).copied();
        Some(now)
    });
    let n_sectors = sectors.len().div_ceil(len);
    places.take(n_sectors).map_while(|place| sector(sectors, len, place)).flatten().copied().collect()
}

/// The last one may be cut off. Marks for the end of a chain and the like are numbers that no sector has.
fn sector(sectors: &[u8], len: usize, place: u32) -> Option<&[u8]> {
    let rest = sectors.get((place as usize).checked_mul(len)?..)?;
    (!rest.is_empty()).then(|| &rest[..rest.len().min(len)])
}
