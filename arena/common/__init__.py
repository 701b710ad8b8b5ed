"""What all of the arena builds on: plain values, arrays, HTML, locks, parallel calls."""
