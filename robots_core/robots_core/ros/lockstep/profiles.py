"""Quality of service of the topics of lock-step."""

from typing import Final

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile

LATCHED_BY_MANY: Final = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
ALL: Final = QoSProfile(depth=1000)

# Every kind of event is one more thing to wait for; by default each endpoint warns of incompatible qualities.
NO_PUBLISHER_EVENTS: Final = PublisherEventCallbacks(use_default_callbacks=False)
NO_SUBSCRIPTION_EVENTS: Final = SubscriptionEventCallbacks(use_default_callbacks=False)
