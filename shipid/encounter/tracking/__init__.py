"""From detections to tracks: motion, association, initiation and deletion, and what a track says."""
