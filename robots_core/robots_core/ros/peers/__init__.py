"""Who else is there: heartbeats, presence, namesakes, publishers and their names."""
