//! Formats that other programs convert to readable ones, and by which command: an extension, its name, the way out.
//!
//! Called where an extension is none that is read. A line that is copied and run leaves a file that is read.

use std::path::Path;

/// A way out, with `{in}` for the file and `{out}` for its name without the extension.
type WayOut = (&'static [&'static str], &'static str, &'static str);

const LOGS: [WayOut; 17] = [
    (&["zip"], "an archive", "unpack it: unzip '{in}'"),
    (&["7z"], "an archive", "unpack it: 7z x '{in}'"),
    (&["tar", "tgz", "tbz2", "txz"], "an archive", "unpack it: tar xf '{in}'"),
    (&["gz"], "a packed log", "unpack it: gunzip -k '{in}'"),
    (&["zst", "zstd"], "a packed log", "unpack it: zstd -d '{in}'"),
    (&["xz"], "a packed log", "unpack it: xz -dk '{in}'"),
    (&["bz2"], "a packed log", "unpack it: bunzip2 -k '{in}'"),
    (&["lz4"], "a packed log", "unpack it: lz4 -d '{in}'"),
    (
        &["arrow", "arrows", "feather", "ipc"],
        "an Arrow file",
        "write Parquet: python3 -c \"import pyarrow as a, pyarrow.feather as f, pyarrow.parquet as p; n = '{in}'; s = open(n, 'rb').read(4) not in (b'ARRO', b'FEA1'); p.write_table(a.ipc.open_stream(open(n, 'rb')).read_all() if s else f.read_table(n), '{out}.parquet')\"",
    ),
    (
        &["orc"],
        "an ORC file",
        "write Parquet: python3 -c \"import pyarrow.orc as o, pyarrow.parquet as p; p.write_table(o.read_table('{in}'), '{out}.parquet')\"",
    ),
    (
        &["tdms"],
        "a file of LabVIEW",
        "write Parquet (pip install npTDMS pandas pyarrow): python3 -c \"import nptdms; f = nptdms.TdmsFile.read('{in}'); t = any('wf_start_offset' in c.properties for g in f.groups() for c in g.channels()); d = f.as_dataframe(time_index=t).rename(columns=lambda c: c.split(chr(39))[-2]); (d.rename_axis('time_s') if t else d).to_parquet('{out}.parquet', index=t)\"",
    ),
    (
        &["ulg", "ulog"],
        "a log of PX4",
        "write a CSV file for each of its topics (pip install pyulog): ulog2csv '{in}', and give that of the accelerations with the map that itpms signals --write-map writes",
    ),
    (
        &["xlsx", "xls", "xlsm", "ods"],
        "a workbook",
        "save its sheet as CSV, or: python3 -c \"import pandas; pandas.read_excel('{in}').to_csv('{out}.csv', index=False)\"",
    ),
    (
        &["pcap", "pcapng"],
        "a capture of packets",
        "write its frames as candump does (pip install scapy): python3 -c \"from scapy.all import *; from scapy.layers.can import CAN; [print('(%.6f) can0 %s#%s' % (p.time, ('%08X' if 'extended' in p[CAN].flags else '%03X') % p[CAN].identifier, bytes(p[CAN].data).hex())) for p in PcapReader('{in}') if CAN in p]\" > '{out}.log'",
    ),
    (
        &["mat"],
        "a file of MATLAB",
        "export CSV or Parquet there, writetable(T, 'drive.csv') or parquetwrite('drive.parquet', T), or of its arrays (pip install scipy pandas pyarrow): python3 -c \"import pandas, scipy.io as s; m = {k: v for k, v in s.loadmat('{in}', simplify_cells=True).items() if k[0] != '_'}; pandas.DataFrame(m if len(m) > 1 else next(iter(m.values()))).to_parquet('{out}.parquet')\"",
    ),
    (
        &["h5", "hdf5", "hdf"],
        "an HDF5 file",
        "write Parquet of its arrays (pip install h5py pandas pyarrow): python3 -c \"import h5py, pandas; d = {}; h5py.File('{in}').visititems(lambda n, o: d.update({k: o[k] for k in o.dtype.names} if o.dtype.names else {n.split('/')[-1]: o[:]}) if isinstance(o, h5py.Dataset) and o.ndim == 1 else None); pandas.DataFrame(d).to_parquet('{out}.parquet')\", of a file of pandas: python3 -c \"import pandas; pandas.read_hdf('{in}').to_parquet('{out}.parquet')\"",
    ),
    (
        &["dbc", "kcd", "sym", "arxml"],
        "a description of frames and no log",
        "give the log, and this with --dbc (as a DBC file)",
    ),
];

#[cfg(feature = "can")]
const CANTOOLS: &str = "python3 -c \"import cantools; cantools.database.dump_file(cantools.database.load_file('{in}', strict=False), '{out}.dbc')\"";

/// Kind of a file with this extension, and the remedy, as the text after "drive.zip: ".
pub(crate) fn of_log(path: &Path, extension: &str) -> Option<String> {
    // `drive.gz` could be anything.
    let is_named = || Path::new(path.file_stem().unwrap_or_default()).extension().is_some();
    let extension = Some(extension).filter(|extension| *extension != "gz" || is_named())?;
    let (_, what, way_out) = LOGS.iter().find(|(extensions, ..)| extensions.contains(&extension))?;
    Some(format!("{what}, which is not read as a log; {}", filled(way_out, path)))
}

/// The same of a file that is to describe a bus.
#[cfg(feature = "can")]
pub(crate) fn of_description(path: &Path) -> Option<String> {
    let extension = path.extension()?.to_string_lossy().to_lowercase();
    ["kcd", "sym", "arxml"].contains(&extension.as_str()).then(|| {
        let line = filled(CANTOOLS, path);
        format!("a description of frames as {}, expected a DBC file, which is written by (pip install cantools): {line}", extension.to_uppercase())
    })
}

fn filled(line: &str, path: &Path) -> String {
    let name = path.display().to_string();
    // Of `drive.log.gz` and the like the rest is a name, too.
    let stem = path.with_extension("").display().to_string();
    line.replace("{in}", &name).replace("{out}", &stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_extension_is_there_twice_and_lines_are_complete() {
        let all: Vec<&str> = LOGS.iter().flat_map(|(extensions, ..)| extensions.iter().copied()).collect();
        for (place, extension) in all.iter().enumerate() {
            assert!(!all[..place].contains(extension), "{extension}");
            let text = of_log(Path::new(&format!("logs/a.log.{extension}")), extension).unwrap();
            assert!(!text.contains("{in}") && !text.contains("{out}"), "{text}");
        }
        let text = of_log(Path::new("logs/a.feather"), "feather").unwrap();
        assert!(text.contains("'logs/a.feather'") && text.contains("'logs/a.parquet'"), "{text}");
        assert!(of_description(Path::new("car.ARXML")).unwrap().contains("'car.dbc'"));
        assert_eq!(of_description(Path::new("car.dbc")), None);
    }
}
