"""What algorithms share: schedules, exploration, updates, traces."""
