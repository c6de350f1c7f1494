//! Bytes as result files and shards.

use poinsot::campaign::ShardSums;
use poinsot_formats::{
    CampaignFile, ComparisonFile, DesignFile, EstimateFile, PredictionFile, ReportData, ResultFile,
    TruthFile, ValidationFile, parse_result, result_text, sha256,
};

/// Bytes as every result file, as they are and with a correct checksum. An accepted file is written and read again.
pub fn results(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let body = text.trim_end();
    let body = body.strip_suffix('}').unwrap_or(body).trim_end();
    let sum = sha256(body.as_bytes());
    let sealed = format!("{body},\n  \"sha256\": \"{sum}\"\n}}\n");
    for text in [text, &sealed] {
        check::<EstimateFile>(text);
        check::<TruthFile>(text);
        check::<PredictionFile>(text);
        check::<ValidationFile>(text);
        check::<ComparisonFile>(text);
        check::<DesignFile>(text);
        check::<CampaignFile>(text);
        check::<ReportData>(text);
        check::<ShardSums>(text);
        let _ = ShardSums::parse(text);
    }
}

fn check<T: ResultFile>(text: &str) {
    match parse_result::<T>("result.json".as_ref(), text.as_bytes()) {
        Ok(file) => {
            let written = result_text(&file, true).ok();
            let again = written.as_ref().and_then(|text| {
                let file = parse_result::<T>("written.json".as_ref(), text.as_bytes());
                result_text(&file.ok()?, true).ok()
            });
            assert_eq!(again, written, "what was written is not read");
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(error.code()), "no code: {text}");
        }
    }
}
