#![no_main]
libfuzzer_sys::fuzz_target!(|data: &[u8]| catoptric_fuzz::usd_attributes(data));
